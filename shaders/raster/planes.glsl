// Triangles by their numbers: from bit TRIANGLE_BITS on the object, from 0, and below the triangle, from 1.
uniform samplerBuffer u_planes; // n and d of n p + d = 0 about the scene's centre, with |n| = 1

vec4 plane_of(uint number) {
    return texelFetch(u_planes, int(number & ((1u << TRIANGLE_BITS) - 1u)) - 1);
}

// The depth that stands for an object
float object_depth(uint number) {
    return float((number >> TRIANGLE_BITS) + 1u) / OBJECTS;
}
