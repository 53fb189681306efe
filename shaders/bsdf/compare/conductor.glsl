// A metal given by its measured complex index eta + i k: f = D V F + f_ms with GGX, height-correlated Smith, exact
// Fresnel reflectance and Kulla-Conty multiple scattering.
#include "bsdf/fresnel_metal.glsl"
#include "bsdf/kulla_conty.glsl"
#include "sample/lattice.glsl"

struct Conductor {
    vec3 eta;
    vec3 k;
    vec2 alpha; // along the tangent, across it
};

// 2 int F mu dmu by Gauss-Legendre quadrature with 4 nodes; the error is at most 0.002.
vec3 conductor_mean(Conductor m) {
    return 0.0241539 * f_conductor(0.0694318442, m.eta, m.k) + 0.2152133 * f_conductor(0.330009478, m.eta, m.k)
         + 0.4369311 * f_conductor(0.669990522, m.eta, m.k) + 0.3237018 * f_conductor(0.930568156, m.eta, m.k);
}

vec3 conductor_eval(Conductor m, vec3 wo, vec3 wi, sampler2D dfg) {
    float VoH;
    float dv = ggx_reflection(m.alpha, wo, wi, VoH);
    return dv * f_conductor(VoH, m.eta, m.k) + kulla_conty_eval(m.alpha, conductor_mean(m), wo, wi, dfg);
}

float conductor_diffuse_probability(Conductor m, vec3 wo, sampler2D dfg) {
    return kulla_conty_probability(m.alpha, conductor_mean(m), wo, dfg);
}

float conductor_pdf(Conductor m, vec3 wo, vec3 wi, sampler2D dfg) {
    return compensated_pdf(m.alpha, conductor_diffuse_probability(m, wo, dfg), wo, wi);
}

BsdfSample conductor_sample(Conductor m, vec3 wo, vec3 u, sampler2D dfg) {
    float VoH;
    BsdfSample s = compensated_direction(m.alpha, conductor_diffuse_probability(m, wo, dfg), wo, u, VoH);
    s.weight = compensated_weight(s, conductor_eval(m, wo, s.wi, dfg), f_conductor(VoH, m.eta, m.k));
    return s;
}

// The mean of F over 32 samples of the visible facets, times the albedo for F = 1 from the table; the error is at most
// 0.005.
vec3 conductor_albedo(Conductor m, float NoV, sampler2D dfg) {
    float r = mean_perceptual_roughness(m.alpha);
    vec3 F = vec3(0.0);
    float sum = 0.0;
    for (uint i = 0u; i < 32u; ++i) {
        float VoH;
        float weight = ggx_visible_point(r * r, NoV, hammersley(i, 32u), VoH);
        F += weight * f_conductor(VoH, m.eta, m.k);
        sum += weight;
    }
    return F * (ggx_white_albedo(dfg, NoV, r) / max(sum, 1e-6))
         + kulla_conty_albedo(m.alpha, conductor_mean(m), NoV, dfg);
}
