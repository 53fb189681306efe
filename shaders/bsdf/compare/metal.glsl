// A metal given by colours: f = D V F + f_ms with GGX, height-correlated Smith, F82-tint and Kulla-Conty multiple
// scattering.
#include "bsdf/fresnel_metal.glsl"
#include "bsdf/kulla_conty.glsl"
#include "sample/lattice.glsl"

struct Metal {
    vec3 f0;
    vec3 tint;  // factor on Schlick's reflectance at 82 degrees; 1 does not change Schlick's curve
    vec2 alpha; // along the tangent, across it
};

vec3 metal_eval(Metal m, vec3 wo, vec3 wi, sampler2D dfg) {
    float VoH;
    float dv = ggx_reflection(m.alpha, wo, wi, VoH);
    return dv * f_f82_tint(m.f0, m.tint, VoH)
         + kulla_conty_eval(m.alpha, f_f82_tint_mean(m.f0, m.tint), wo, wi, dfg);
}

float metal_diffuse_probability(Metal m, vec3 wo, sampler2D dfg) {
    return kulla_conty_probability(m.alpha, f_f82_tint_mean(m.f0, m.tint), wo, dfg);
}

float metal_pdf(Metal m, vec3 wo, vec3 wi, sampler2D dfg) {
    return compensated_pdf(m.alpha, metal_diffuse_probability(m, wo, dfg), wo, wi);
}

BsdfSample metal_sample(Metal m, vec3 wo, vec3 u, sampler2D dfg) {
    float VoH;
    BsdfSample s = compensated_direction(m.alpha, metal_diffuse_probability(m, wo, dfg), wo, u, VoH);
    s.weight = compensated_weight(s, metal_eval(m, wo, s.wi, dfg), f_f82_tint(m.f0, m.tint, VoH));
    return s;
}

// The mean of F over 32 samples of the visible facets, times the albedo for F = 1 from the table; the error is at most
// 0.005.
vec3 metal_albedo(Metal m, float NoV, sampler2D dfg) {
    float r = mean_perceptual_roughness(m.alpha);
    vec3 F = vec3(0.0);
    float sum = 0.0;
    for (uint i = 0u; i < 32u; ++i) {
        float VoH;
        float weight = ggx_visible_point(r * r, NoV, hammersley(i, 32u), VoH);
        F += weight * f_f82_tint(m.f0, m.tint, VoH);
        sum += weight;
    }
    return F * (ggx_white_albedo(dfg, NoV, r) / max(sum, 1e-6))
         + kulla_conty_albedo(m.alpha, f_f82_tint_mean(m.f0, m.tint), NoV, dfg);
}
