// Single reflection by GGX facets without the Fresnel reflectance, which the metals and glasses share.
//   D V = D(h) G2(wo, wi) / (4 NoV NoL),   h = norm(wo + wi)                     Walter et al. 2007, eq. 20
// Sampled by bounded visible normals. alpha = (alpha_t, alpha_b); below DELTA_ALPHA it is a mirror.
#include "bsdf/bsdf.glsl"
#include "bsdf/visible_normal.glsl"
#include "light/dfg.glsl"

// Perceptual roughness of the isotropic lobe that replaces an anisotropic one in lookups of the DFG table
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

// weight = D V NoL / pdf = NoL (k NoV + T_o) / (T_o NoL + T_i NoV), at most 1. D cancels and is not evaluated.
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

// One sample of the facets visible from wo: their VoH, and their weight in the albedo. For means of F over the facets.
float ggx_visible_point(float alpha, float NoV, vec2 u, out float VoH) {
    vec3 wo = vec3(sqrt(max(1.0 - NoV * NoV, 0.0)), 0.0, NoV);
    return ggx_reflection_sample(vec2(alpha), wo, u, VoH).weight.x;
}
