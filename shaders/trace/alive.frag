// Whether any slot of a block has something to do, a pixel a block.
#include "trace/numbers.glsl"

out float o_alive;

void main() {
    ivec2 low = ivec2(gl_FragCoord.xy) * TILE;
    o_alive = 0.0;
    for (int k = 0; k < TILE * TILE && o_alive == 0.0; ++k) {
        if (texelFetch(u_origin, low + ivec2(k % TILE, k / TILE), 0).w != IDLE) o_alive = 1.0;
    }
}
