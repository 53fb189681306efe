// Draws a square of TILE x TILE texels for each block in `a_block`.
in int a_block;

uniform ivec2 u_grid; // of blocks: columns, rows

void main() {
    ivec2 corner = ivec2(a_block % u_grid.x, a_block / u_grid.x) + ivec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(2.0 * vec2(corner) / vec2(u_grid) - 1.0, 0.0, 1.0);
}
