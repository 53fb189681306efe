// A rectangle of the ground's map, outside of which nothing hides a light.
in vec3 a_u, a_v;  // rows of the matrix from a point of the ground (x, z, 1) to the light's tile, in (0, 1)
in vec4 a_tile;    // its corner and its size in the atlas, in texture coordinates
in vec4 a_box;     // the rectangle's lower and upper corner
in float a_part;   // of all the light that falls on the ground

flat out vec3 v_u, v_v;
flat out vec4 v_tile;
flat out float v_part;

void main() {
    v_u = a_u;
    v_v = a_v;
    v_tile = a_tile;
    v_part = a_part;
    gl_Position = vec4(mix(a_box.xy, a_box.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1)), 0.0, 1.0);
}
