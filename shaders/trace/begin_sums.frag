// Begins the sums of blocks: with all the samples of pixels that no triangle can touch, and 0 elsewhere.
#include "trace/numbers.glsl"
#include "trace/sky_sums.glsl"

uniform sampler2D u_sky;
#if CHOOSES_PIXELS
uniform sampler2D u_chosen; // 1 at the homes of the pixels that the work items are for
#endif
uniform ivec2 u_size; // of the picture

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    ivec4 block = texelFetch(u_blocks, texel / TILE, 0);
    ivec2 pixel = block.xy * TILE + texel % TILE;
    bool is_inside = all(lessThan(pixel, u_size));
#if CHOOSES_PIXELS
    is_inside = is_inside && texelFetch(u_chosen, texel, 0).r > 0.0;
#endif
    write_sky(is_inside ? texelFetch(u_sky, pixel, 0) : vec4(0.0), block.w);
}
