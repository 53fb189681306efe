// Blinn's highlight about the half vector (Blinn 1977), under two normalisations.
//   blinn:            f = k_s (s + 8) / (8 pi) NoH^s. Akenine-Moller et al. 2018, "Real-Time Rendering", section 9.8;
//                     up to 7 % too bright.
//   normalized_blinn: f = k_s (s + 2) (s + 4) / (8 pi (2^(-s/2) + s)) NoH^s, which reflects all at normal incidence and
//                     never more. Giesen 2009, "Phong and Blinn-Phong normalization factors".
// Half vectors are sampled with the density (s + 1) / (2 pi) NoH^s, so directions have that density / (4 VoH).
#include "bsdf/accurate.glsl"
#include "bsdf/bsdf.glsl"
#include "bsdf/phong.glsl"
#include "sample/lattice.glsl"

struct Blinn {
    vec3 specular; // k_s
    float shininess;
};

// 8 pi times the normalisation factor
float blinn_factor(float s) {
    return s + 8.0;
}

float normalized_blinn_factor(float s) {
    return (s + 2.0) * (s + 4.0) / (exp2(-0.5 * s) + s);
}

vec3 blinn_half(float shininess, vec2 u) {
    // 1 - cos^2, cos = (1 - u)^(1 / (s + 1))
    float sin2 = one_minus_exp_fast(-2.0 * log(1.0 - u.x) / (shininess + 1.0));
    float phi = 2.0 * PI * u.y;
    return vec3(sqrt(sin2) * vec2(cos(phi), sin(phi)), sqrt(1.0 - sin2));
}

float blinn_pdf(Blinn m, vec3 wo, vec3 wi) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return 0.0;
    vec3 h = normalize(wo + wi);
    return (m.shininess + 1.0) * 0.125 * INV_PI * pow(h.z, m.shininess) / max(dot(wo, h), 1e-18);
}

vec3 blinn_eval(Blinn m, vec3 wo, vec3 wi) {
    return wo.z > 0.0 && wi.z > 0.0 ? m.specular * f_blinn(normalize(wo + wi).z, m.shininess) : vec3(0.0);
}

// weight = f NoL / pdf = factor VoH NoL / (s + 1)
BsdfSample blinn_sample_scaled(Blinn m, vec3 wo, vec3 u, float factor) {
    vec3 h = blinn_half(m.shininess, u.xy);
    float VoH = dot(wo, h);
    vec3 wi = 2.0 * VoH * h - wo;
    if (wo.z <= 0.0 || wi.z <= 0.0 || VoH <= 0.0) return NO_SAMPLE;
    vec3 weight = m.specular * (factor * VoH * wi.z / (m.shininess + 1.0));
    return BsdfSample(wi, weight, blinn_pdf(m, wo, wi), REFLECTION, 1.0);
}

// Directional albedo from 64 samples; the error is at most 0.02.
vec3 blinn_albedo_scaled(Blinn m, float NoV, float factor) {
    vec3 wo = vec3(sqrt(max(1.0 - NoV * NoV, 0.0)), 0.0, NoV);
    vec3 sum = vec3(0.0);
    for (uint i = 0u; i < 64u; ++i) sum += blinn_sample_scaled(m, wo, vec3(hammersley(i, 64u), 0.0), factor).weight;
    return sum / 64.0;
}

BsdfSample blinn_sample(Blinn m, vec3 wo, vec3 u) {
    return blinn_sample_scaled(m, wo, u, blinn_factor(m.shininess));
}

vec3 blinn_albedo(Blinn m, float NoV) {
    return blinn_albedo_scaled(m, NoV, blinn_factor(m.shininess));
}

vec3 normalized_blinn_eval(Blinn m, vec3 wo, vec3 wi) {
    return blinn_eval(m, wo, wi) * (normalized_blinn_factor(m.shininess) / blinn_factor(m.shininess));
}

float normalized_blinn_pdf(Blinn m, vec3 wo, vec3 wi) {
    return blinn_pdf(m, wo, wi);
}

BsdfSample normalized_blinn_sample(Blinn m, vec3 wo, vec3 u) {
    return blinn_sample_scaled(m, wo, u, normalized_blinn_factor(m.shininess));
}

vec3 normalized_blinn_albedo(Blinn m, float NoV) {
    return blinn_albedo_scaled(m, NoV, normalized_blinn_factor(m.shininess));
}
