// Light reflected once by GGX facets, without their Fresnel reflectance: what every metal and glass has in common.
//   D V = D(h) G2(wo, wi) / (4 NoV NoL),   h = norm(wo + wi)                     Walter et al. 2007, eq. 20
// Sampled by bounded visible normals. alpha = (alpha_t, alpha_b), under DELTA_ALPHA a mirror.
#include "bsdf/bsdf.glsl"
#include "bsdf/visible_normal.glsl"
#include "light/dfg.glsl"

// Of the isotropic lobe that stands for an anisotropic one in the table of albedos
float mean_perceptual_roughness(vec2 alpha) {
    return is_delta(alpha) ? 0.0 : pow(alpha.x * alpha.y, 0.25);
}

// D V
float ggx_reflection(vec2 alpha, vec3 wo, vec3 wi, out float VoH) {
    VoH = 0.0;
    if (wo.z <= 0.0 || wi.z <= 0.0 || is_delta(alpha)) return 0.0;
    vec2 a = finite_alpha(alpha);
    vec3 h = normalize(wo + wi);
    VoH = clamp(dot(wo, h), 0.0, 1.0);
    return d_ggx_local(h, a) * v_smith_ggx_local(wo, wi, a);
}

float ggx_reflection_pdf(vec2 alpha, vec3 wo, vec3 wi) {
    if (wo.z <= 0.0 || wi.z <= 0.0 || is_delta(alpha)) return 0.0;
    vec2 a = finite_alpha(alpha);
    return pdf_visible_reflection(wo, normalize(wo + wi), a, cap_bound(wo, a));
}

// weight = D V NoL / pdf = NoL (k NoV + T_o) / (T_o NoL + T_i NoV), at most 1: D is never formed and divided by
BsdfSample ggx_reflection_sample(vec2 alpha, vec3 wo, vec2 u, out float VoH) {
    VoH = wo.z;
    if (wo.z <= 0.0) return NO_SAMPLE;
    if (is_delta(alpha)) return BsdfSample(vec3(-wo.xy, wo.z), vec3(1.0), 1.0, REFLECTION | DELTA, 1.0);
    vec2 a = finite_alpha(alpha);
    float bound = cap_bound(wo, a);
    vec3 h = sample_visible_normal(wo, a, bound, u);
    VoH = clamp(dot(wo, h), 0.0, 1.0);
    vec3 wi = normalize(2.0 * VoH * h - wo);
    if (wi.z <= 0.0) return NO_SAMPLE;
    float t_o = smith_t(wo, a);
    float weight = wi.z * (bound * wo.z + t_o) / (t_o * wi.z + smith_t(wi, a) * wo.z);
    return BsdfSample(wi, vec3(weight), pdf_visible_reflection(wo, h, a, bound), REFLECTION, 1.0);
}

// The mean of F over the facets that wo sees needs their VoH: point i of n, with the weight it has in the albedo.
float ggx_visible_point(float alpha, float NoV, vec2 u, out float VoH) {
    vec3 wo = vec3(sqrt(max(1.0 - NoV * NoV, 0.0)), 0.0, NoV);
    return ggx_reflection_sample(vec2(alpha), wo, u, VoH).weight.x;
}
