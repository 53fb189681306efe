// Thin-walled glass: two parallel interfaces without a distance between them, so transmitted light keeps its direction.
// Including all reflections between the interfaces, R' = R + T^2 R (1 + R^2 + ...) = 2 R / (1 + R), T' = 1 - R'.
// The transmitted lobe of a rough wall is the mirror image of the reflected one (KHR_materials_transmission):
//   f_r(o, i) = R'(VoH) D V(o, i),   f_t(o, i) = T'(VoH) D V(o, i*),   i* is i mirrored through the plane
#include "bsdf/fresnel.glsl"
#include "bsdf/ggx_masking.glsl"
#include "bsdf/ggx_reflection.glsl"
#include "bsdf/lobe/glass_fresnel.glsl"

struct ThinDielectric {
    float eta;  // index of the wall over that of the surrounding medium, >= 1
    vec2 alpha; // along the tangent, across it
    vec3 f0, f90; // if IRIDESCENT, of one bare interface, and the film on both
    float film, film_ior, film_thickness;
};

// R'
REFLECTANCE f_thin(ThinDielectric m, float mu) {
#if IRIDESCENT
    vec3 R = filmed_glass(m.f0, m.f90, Film(m.film, m.film_ior, m.film_thickness, 0.0), mu, m.eta);
#else
    float R = f_dielectric(mu, m.eta);
#endif
    return 2.0 * R / (1.0 + R);
}

vec3 to_upper_side(vec3 w) {
    return vec3(w.xy, abs(w.z));
}

// The fraction of light that the facet h scatters to wi's side: R' or T'
REFLECTANCE thin_fraction(ThinDielectric m, vec3 wo, vec3 wi, vec3 h) {
    REFLECTANCE R = f_thin(m, clamp(dot(wo, h), 0.0, 1.0));
    return wi.z > 0.0 ? R : 1.0 - R;
}

vec3 thin_dielectric_eval(ThinDielectric m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || wi.z == 0.0 || is_delta(m.alpha)) return vec3(0.0);
    vec2 a = finite_alpha(m.alpha);
    vec3 up = to_upper_side(wi), h = normalize(wo + up);
    return vec3(thin_fraction(m, wo, wi, h) * d_ggx_local(h, a) * v_masked_ggx(wo, up, a));
}

float thin_dielectric_pdf(ThinDielectric m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || wi.z == 0.0 || is_delta(m.alpha)) return 0.0;
    vec2 a = finite_alpha(m.alpha);
    vec3 h = normalize(wo + to_upper_side(wi));
    return mean_of(thin_fraction(m, wo, wi, h)) * pdf_visible_reflection(wo, h, a, cap_bound(wo, a));
}

BsdfSample thin_dielectric_sample(ThinDielectric m, vec3 wo, vec3 u, sampler2D dfg) {
    if (wo.z <= 0.0) return NO_SAMPLE;
    bool is_smooth = is_delta(m.alpha);
    vec2 a = finite_alpha(m.alpha);
    float bound = cap_bound(wo, a);
    vec3 h = is_smooth ? vec3(0.0, 0.0, 1.0) : sample_visible_normal(wo, a, bound, u.xy);
    float VoH = clamp(dot(wo, h), 0.0, 1.0);
    REFLECTANCE R = f_thin(m, VoH);
    bool is_reflected = u.z < mean_of(R);
    REFLECTANCE scattered = is_reflected ? R : 1.0 - R;
    float share = mean_of(scattered);
    uint side = is_reflected ? REFLECTION : TRANSMISSION;
    vec3 up = normalize(2.0 * VoH * h - wo);
    if (up.z <= 0.0) return NO_SAMPLE;
    vec3 wi = is_reflected ? up : vec3(up.xy, -up.z);
    if (is_smooth) return BsdfSample(wi, over_mean(scattered, share), share, side | DELTA, 1.0);
    float weight = masked_reflection_weight(wo, up, a, bound);
    float pdf = share * pdf_visible_reflection(wo, h, a, bound);
    return BsdfSample(wi, weight * over_mean(scattered, share), pdf, side, 1.0);
}

// R' + T' = 1, so the albedo is that of facets with F = 1.
vec3 thin_dielectric_albedo(ThinDielectric m, float NoV, sampler2D dfg) {
    vec2 ab = dfg_albedo(dfg, NoV, mean_perceptual_roughness(m.alpha));
    return vec3(ab.x + ab.y);
}
