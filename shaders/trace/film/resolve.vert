// Draws a square of TILE x TILE pixels, at its tile of the picture, for each block of the wavefront in `a_block`.
in int a_block;

uniform isampler2D u_blocks; // tile x, tile y
uniform vec2 u_size;         // of the picture

flat out ivec2 v_to_texel;   // offset from a pixel to its texel in the wavefront

void main() {
    int columns = textureSize(u_blocks, 0).x;
    ivec2 block = ivec2(a_block % columns, a_block / columns);
    ivec2 tile = texelFetch(u_blocks, block, 0).xy;
    vec2 pixel = vec2((tile + ivec2(gl_VertexID & 1, gl_VertexID >> 1)) * TILE);
    gl_Position = vec4(2.0 * pixel / u_size - 1.0, 0.0, 1.0);
    v_to_texel = (block - tile) * TILE;
}
