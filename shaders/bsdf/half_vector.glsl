// Samples half vectors for the distribution NDF of microfacet.glsl: GGX by bounded visible normals, the others with
// p(h) = D NoH, a density with respect to solid angle, since it integrates to 1 (Walter et al. 2007, eqs. 28 to 31).
#include "bsdf/accurate.glsl"
#include "bsdf/microfacet.glsl"
#if NDF == 0
#include "bsdf/visible_normal.glsl"
#endif

// Beckmann: tan^2 = -alpha^2 log(1 - u)
// Blinn-Phong: cos^(s + 2) = 1 - u, with s + 2 = 2 / alpha^2: sin^2 = 1 - (1 - u)^(alpha^2)
vec3 sample_half(vec3 wo, float alpha, vec2 u) {
#if NDF == 0
    return sample_visible_normal(wo, vec2(alpha), cap_bound(wo, vec2(alpha)), u);
#else
    float x = -alpha * alpha * log(1.0 - u.x);
#if NDF == 1
    float sin2 = x / (1.0 + x);
#else
    float sin2 = one_minus_exp_fast(x);
#endif
    float phi = 2.0 * PI * u.y;
    return vec3(sqrt(sin2) * vec2(cos(phi), sin(phi)), sqrt(1.0 - sin2));
#endif
}

// Density of the direction reflected at h, with respect to solid angle
float pdf_half_reflection(vec3 wo, vec3 h, float alpha) {
#if NDF == 0
    return pdf_visible_reflection(wo, h, vec2(alpha), cap_bound(wo, vec2(alpha)));
#else
    return d_microfacet(h.z, dot(h.xy, h.xy), alpha) * h.z / (4.0 * max(dot(wo, h), 1e-18));
#endif
}
