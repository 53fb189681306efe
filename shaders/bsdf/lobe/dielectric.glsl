// Rough glass with single scattering: GGX facets that reflect the fraction F of the light and refract the rest.
//   reflected:   f_r = D G2 F / (4 NoV NoL)
//   transmitted: f_t = (1 - F) D G2 |VoH LoH| / (NoV |NoL| (LoH + VoH/eta)^2) / eta^2,  h along -(wo + eta wi)
// Walter et al. 2007, eqs. 20, 21 and 16. eta is the index on the far side over that on wo's side. The factor 1 / eta^2
// is for radiance, which is greater in the medium with the higher index. G2 is that of ggx_masking.glsl. F is always
// exact, since Schlick's approximation has no critical angle.
#include "bsdf/bsdf.glsl"
#include "bsdf/fresnel.glsl"
#include "bsdf/ggx_masking.glsl"
#include "bsdf/lobe/glass_fresnel.glsl"
#include "bsdf/visible_normal.glsl"
#include "sample/lattice.glsl"

struct Dielectric {
    float eta;
    vec2 alpha; // along the tangent, across it
    vec3 f0, f90; // if IRIDESCENT, of the bare interface seen from outside, and the film on it
    float film, film_ior, film_thickness;
};

REFLECTANCE dielectric_reflectance(Dielectric m, float mu) {
#if IRIDESCENT
    return filmed_glass(m.f0, m.f90, Film(m.film, m.film_ior, m.film_thickness, 0.0), mu, m.eta);
#else
    return f_dielectric(mu, m.eta);
#endif
}

// Whether transmission is treated as smooth. The transmitted lobe has a width of about alpha |eta - 1|; below
// DELTA_ALPHA it is too narrow for float32 directions. Dividing by the lower index gives the same answer from both
// sides.
bool transmits_straight(Dielectric m) {
    return max(m.alpha.x, m.alpha.y) * abs(m.eta - 1.0) < DELTA_ALPHA * min(m.eta, 1.0);
}

// wi = wo refracted at h, VoH >= 0. Returns false for total internal reflection.
bool refract_at(vec3 wo, vec3 h, float eta, out vec3 wi) {
    float c = dot(wo, h);
    float cos2_t = 1.0 - (1.0 - c * c) / (eta * eta);
    wi = normalize((c / eta - sqrt(max(cos2_t, 0.0))) * h - wo / eta);
    return cos2_t > 0.0;
}

// The half vector of refraction, oriented towards +z
vec3 refracting_half(vec3 wo, vec3 wi, float eta) {
    vec3 h = wo + eta * wi;
    return h * (h.z < 0.0 ? -1.0 : 1.0) / max(length(h), 1e-18);
}

vec3 dielectric_eval(Dielectric m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || is_delta(m.alpha)) return vec3(0.0);
    vec2 a = finite_alpha(m.alpha);
    if (wi.z > 0.0) {
        vec3 h = normalize(wo + wi);
        REFLECTANCE F = dielectric_reflectance(m, clamp(dot(wo, h), 0.0, 1.0));
        return vec3(d_ggx_local(h, a) * v_masked_ggx(wo, wi, a) * F);
    }
    if (wi.z == 0.0 || transmits_straight(m)) return vec3(0.0);
    vec3 h = refracting_half(wo, wi, m.eta);
    float VoH = dot(wo, h), LoH = dot(wi, h);
    if (VoH <= 0.0 || LoH >= 0.0) return vec3(0.0);
    float g2 = g2_transmission_ggx(lambda_ggx_local(wo, a), lambda_ggx_local(wi, a));
    float jacobian = m.eta * LoH + VoH;
    return vec3((1.0 - dielectric_reflectance(m, VoH)) * d_ggx_local(h, a) * g2 * (VoH / wo.z) * (LoH / wi.z)
                / (jacobian * jacobian));
}

float dielectric_pdf(Dielectric m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || is_delta(m.alpha)) return 0.0;
    vec2 a = finite_alpha(m.alpha);
    if (wi.z > 0.0) {
        vec3 h = normalize(wo + wi);
        return mean_of(dielectric_reflectance(m, clamp(dot(wo, h), 0.0, 1.0))) * pdf_visible_reflection(wo, h, a, 1.0);
    }
    if (wi.z == 0.0 || transmits_straight(m)) return 0.0;
    vec3 h = refracting_half(wo, wi, m.eta);
    float VoH = dot(wo, h), LoH = dot(wi, h);
    if (VoH <= 0.0 || LoH >= 0.0) return 0.0;
    float jacobian = LoH + VoH / m.eta;
    float transmitted = 1.0 - mean_of(dielectric_reflectance(m, VoH));
    return transmitted * pdf_visible_normal(wo, h, a) * -LoH / (jacobian * jacobian);
}

// F of the sampled facet, or below a film its mean over the channels, is the probability of reflection. weight = G2 /
// G1(o), and for transmission G2 / G1(o) / eta^2.
BsdfSample dielectric_sample(Dielectric m, vec3 wo, vec3 u, sampler2D dfg) {
    if (wo.z <= 0.0) return NO_SAMPLE;
    bool is_smooth = is_delta(m.alpha);
    vec2 a = finite_alpha(m.alpha);
    vec3 h = is_smooth ? vec3(0.0, 0.0, 1.0) : sample_visible_normal(wo, a, 1.0, u.xy);
    float VoH = clamp(dot(wo, h), 0.0, 1.0);
    REFLECTANCE F = dielectric_reflectance(m, VoH);
    float p = mean_of(F);
    vec3 wi;
    if (u.z < p) {
        wi = normalize(2.0 * VoH * h - wo);
        if (wi.z <= 0.0) return NO_SAMPLE;
        if (is_smooth) return BsdfSample(wi, over_mean(F, p), p, REFLECTION | DELTA, 1.0);
        float weight = masked_reflection_weight(wo, wi, a, 1.0);
        return BsdfSample(wi, weight * over_mean(F, p), p * pdf_visible_reflection(wo, h, a, 1.0), REFLECTION, 1.0);
    }
    bool is_straight = is_smooth || transmits_straight(m);
    if (!refract_at(wo, is_straight ? vec3(0.0, 0.0, 1.0) : h, m.eta, wi) || wi.z >= 0.0) return NO_SAMPLE;
    float lambda_o = lambda_ggx_local(wo, a);
    float weight = is_smooth ? 1.0 : (1.0 + lambda_o) * g2_transmission_ggx(lambda_o, lambda_ggx_local(wi, a));
    weight /= m.eta * m.eta;
    vec3 share = weight * over_mean(1.0 - F, 1.0 - p);
    if (is_straight) return BsdfSample(wi, share, 1.0 - p, TRANSMISSION | DELTA, m.eta);
    return BsdfSample(wi, share, dielectric_pdf(m, wo, wi, dfg), TRANSMISSION, m.eta);
}

// Fractions of power that are reflected and transmitted, from 64 samples of each; the error is at most 0.01.
mat2x3 dielectric_shares(Dielectric m, float NoV, sampler2D dfg) {
    vec3 wo = vec3(sqrt(max(1.0 - NoV * NoV, 0.0)), 0.0, NoV);
    m.alpha = vec2(sqrt(m.alpha.x * m.alpha.y));
    mat2x3 shares = mat2x3(0.0);
    for (uint i = 0u; i < 64u; ++i) {
        vec3 h = is_delta(m.alpha) ? vec3(0.0, 0.0, 1.0)
                                   : sample_visible_normal(wo, finite_alpha(m.alpha), 1.0, hammersley(i, 64u));
        float p = mean_of(dielectric_reflectance(m, clamp(dot(wo, h), 0.0, 1.0)));
        vec3 u = vec3(hammersley(i, 64u), 0.0);
        if (p > 0.0) shares[0] += p * dielectric_sample(m, wo, u, dfg).weight;
        if (p < 1.0) shares[1] += (1.0 - p) * dielectric_sample(m, wo, vec3(u.xy, 1.0), dfg).weight;
    }
    shares[1] *= m.eta * m.eta;
    return shares / 64.0;
}

vec3 dielectric_albedo(Dielectric m, float NoV, sampler2D dfg) {
    mat2x3 shares = dielectric_shares(m, NoV, dfg);
    return shares[0] + shares[1];
}
