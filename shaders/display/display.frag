// The display pass: exposure, tone map, sRGB encoding and dithering. The output has straight alpha, as PNG.
#include "display/tonemap.glsl"
#include "display/srgb.glsl"

uniform sampler2D u_radiance; // associated alpha
uniform float u_exposure;     // factor, 2^EV
#if BACKDROP
uniform vec3 u_backdrop;      // background colour in linear display light
#endif

out vec4 o_color;

// DITHER: 0 for views of values, whose nearest code is shown.

// Interleaved gradient noise in [0, 1) (Jimenez 2014): it spreads the rounding error over neighbouring pixels, and is
// the same in every frame.
float dither(vec2 pixel) {
    return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715))));
}

void main() {
    vec4 c = texelFetch(u_radiance, ivec2(gl_FragCoord.xy), 0);
    float alpha = clamp(c.a, 0.0, 1.0);
    vec3 straight = c.rgb * (alpha > 1e-30 ? u_exposure / alpha : 0.0);
    vec3 light = clamp(tonemap(straight), 0.0, 1.0);
#if BACKDROP
    light = mix(u_backdrop, light, alpha); // alpha is coverage, so it mixes linear light, not encoded values
    alpha = 1.0;
#endif
    vec3 shown = srgb_from_linear(light);
    // Round up with a probability equal to the fraction. Exact code values are not dithered.
    vec3 code = shown * 255.0;
#if DITHER
    bvec3 exact = lessThan(abs(code - round(code)), vec3(1e-3));
    code = floor(code + mix(vec3(dither(gl_FragCoord.xy)), vec3(0.5), exact));
#else
    code = round(code);
#endif
    o_color = vec4(code * (1.0 / 255.0), alpha);
}
