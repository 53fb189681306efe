// The planes of triangles, by their numbers from 1: n and d of n p + d = 0 about the scene's centre. |n| is the number
// of the triangle's object.
uniform samplerBuffer u_planes;

vec4 plane_of(uint triangle) {
    return texelFetch(u_planes, int(max(triangle, 1u)) - 1);
}

// The depth that stands for an object
float object_depth(vec4 plane) {
    return round(length(plane.xyz)) / OBJECTS;
}
