// Averages the samples of a pixel as resolve.frag does, over surfaces that were shaded over the screen and lie behind
// them.
#include "raster/chosen.glsl"

uniform usampler2D u_chosen;
uniform sampler2D u_first, u_second; // radiance of the first and of the second surface
uniform sampler2DMS u_samples;
out vec4 o_color;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uvec2 bits = chosen_samples(texelFetch(u_chosen, pixel, 0).xy);
    vec4 sum = vec4(0.0), first = texelFetch(u_first, pixel, 0);
    vec2 seen = vec2(0.0);
    for (int k = 0; k < SAMPLES; ++k) {
        vec4 over = texelFetch(u_samples, pixel, k);
        sum += over;
        seen += vec2(bits >> k & 1u) * (1.0 - over.a);
    }
    sum += seen.x > 0.0 ? seen.x * first : vec4(0.0); // nothing was stored there
    sum += seen.y > 0.0 ? seen.y * texelFetch(u_second, pixel, 0) : vec4(0.0);
    o_color = sum / float(SAMPLES);
}
