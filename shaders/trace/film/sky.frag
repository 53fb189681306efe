// Adds the samples of tiles that no triangle can touch to the film, by blending.
#include "trace/sky_sums.glsl"

uniform sampler2D u_sky;

flat in int v_samples;

void main() {
    write_sky(texelFetch(u_sky, ivec2(gl_FragCoord.xy), 0), v_samples);
}
