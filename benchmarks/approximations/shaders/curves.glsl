// The renderer's small functions by other ways: the alternatives that `benchmarks.approximations` measures.
#include "bsdf/ggx.glsl"
#include "display/srgb.glsl"
#include "light/equirect.glsl"

vec3 srgb_by_gamma(vec3 c) {
    return pow(c, vec3(1.0 / 2.2));
}

// Square roots in place of the power     Taylor 2012, "sRGB Approximations for HLSL"
vec3 srgb_by_roots(vec3 c) {
    vec3 s1 = sqrt(c), s2 = sqrt(s1), s3 = sqrt(s2);
    return clamp(0.662002687 * s1 + 0.684122060 * s2 - 0.323583601 * s3 - 0.0225411470 * c, 0.0, 1.0);
}

vec2 equirect_uv_by_functions(vec3 d) {
    return vec2(0.5 + atan(d.z, d.x) * (0.5 * INV_PI), acos(clamp(d.y, -1.0, 1.0)) * INV_PI);
}

float d_ggx_textbook(float NoH, float alpha) {
    float a2 = alpha * alpha;
    float d = NoH * NoH * (a2 - 1.0) + 1.0;
    return a2 * INV_PI / (d * d);
}

// Hammon 2017, "PBR Diffuse Lighting for GGX+Smith Microsurfaces"
float v_hammon_ggx(float NoV, float NoL, float alpha) {
    return 0.5 / mix(2.0 * NoL * NoV, NoL + NoV, alpha);
}
