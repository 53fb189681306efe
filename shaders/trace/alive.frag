// Draws one pixel for each block of TILE x TILE paths: 1 if any of them is not idle, else 0.
#include "trace/numbers.glsl"

out float o_alive;

void main() {
    ivec2 low = ivec2(gl_FragCoord.xy) * TILE;
    o_alive = 0.0;
    for (int k = 0; k < TILE * TILE && o_alive == 0.0; ++k) {
        if (texelFetch(u_origin, low + ivec2(k % TILE, k / TILE), 0).w != IDLE) o_alive = 1.0;
    }
}
