// One direction of one pass of the edge-avoiding a-trous wavelet transform (Dammertz et al. 2010), guided by normal,
// albedo, depth, coverage and the variance of the light itself (Schied et al. 2017).
//
// The pixels p and q exchange light: p gets k w (q - p) and q gets k w (p - q), with the same w for both. So the sum of
// the light stays the same; with a filter that divides by the sum of its weights it would not. As the k sum to 1, each
// result lies between the smallest and the largest value of the input.
#include "sample/luminance.glsl"
#include "trace/denoise/guide.glsl"

uniform sampler2D u_light;  // rgb, variance of the luminance
uniform sampler2D u_guide;
uniform ivec2 u_step;
layout(location = 0) out vec4 o_light;

const float NORMAL = 64.0;     // exp(-64 |dn|^2) is about the cosine to the power of 128
const float COVERAGE = 100.0;
const float ALBEDO = 25.0;     // emitters count as white, so that their light does not spread to darker neighbours
const float SLOPE = 0.5;       // of the depth's predicted change
const float DEPTH = 0.005;     // of the depth
const float DEVIATIONS = 8.0;  // times the variance of the difference: a smaller difference is noise, a larger an edge

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy), size = textureSize(u_light, 0);
    vec4 light = texelFetch(u_light, p, 0), guide = texelFetch(u_guide, p, 0);
    o_light = light;
    if (guide.x < 0.0) return;
    Guide here = unpack_guide(guide.x);
    float own = 1.0, variance = 0.0, l = luminance(light.rgb);
    vec3 change = vec3(0.0);
    for (int k = -2; k <= 2; ++k) {
        ivec2 offset = k * u_step, q = p + offset;
        if (k == 0 || any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, size))) continue;
        vec4 other_guide = texelFetch(u_guide, q, 0);
        if (other_guide.x < 0.0) continue;
        vec4 other = texelFetch(u_light, q, 0);
        Guide there = unpack_guide(other_guide.x);
        vec3 dn = there.normal - here.normal;
        float dc = there.coverage - here.coverage, da = there.albedo - here.albedo;
        float predicted = 0.5 * dot(guide.zw + other_guide.zw, vec2(offset));
        float dz = (other_guide.y - guide.y - predicted)
                   / (SLOPE * abs(predicted) + DEPTH * max(abs(guide.y), abs(other_guide.y)) + 1e-30);
        if (guide.y == NO_DEPTH || other_guide.y == NO_DEPTH) dz = 0.0;
        float dl = luminance(other.rgb) - l;
        float noise = dl * dl / (DEVIATIONS * (light.w + other.w) + 1e-30);
        float w = exp(-NORMAL * dot(dn, dn) - COVERAGE * dc * dc - ALBEDO * da * da - dz * dz - noise * noise);
        w *= abs(k) == 1 ? 0.25 : 0.0625;  // B3 spline: 1 4 6 4 1 / 16
        change += w * (other.rgb - light.rgb);
        own -= w;
        variance += w * w * other.w;
    }
    o_light = vec4(max(light.rgb + change, 0.0), own * own * light.w + variance);
}
