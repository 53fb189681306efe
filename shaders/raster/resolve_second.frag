// Where a pixel shows a second surface, or the first covers some samples alone, their mean: what is blended with the
// first surface, and the part that this has. OVER: with what was drawn over both in the samples, in any pixel.
#include "raster/chosen.glsl"

uniform usampler2D u_chosen;
uniform sampler2D u_second;  // radiance of the second surface
#if OVER
uniform sampler2DMS u_samples;
#endif

layout(location = 0, index = 0) out vec4 o_color;
layout(location = 0, index = 1) out vec4 o_first;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uvec2 bits = chosen_samples(texelFetch(u_chosen, pixel, 0).xy);
    vec4 second = texelFetch(u_second, pixel, 0), sum = vec4(0.0);
    vec2 seen = vec2(0.0);
    bits = bits.x == 0u ? bits.yx : bits; // a background alone was drawn in the place of the first
#if OVER
    for (int k = 0; k < SAMPLES; ++k) {
        vec4 over = texelFetch(u_samples, pixel, k);
        sum += over;
        seen += vec2(bits >> k & 1u) * (1.0 - over.a);
    }
#else
    for (int k = 0; k < SAMPLES; ++k) seen += vec2(bits >> k & 1u);
#endif
    sum += seen.y > 0.0 ? seen.y * second : vec4(0.0); // nothing was stored there
    o_color = sum / float(SAMPLES);
    o_first = vec4(seen.x / float(SAMPLES));
}
