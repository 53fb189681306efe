// GGX with diffuse multiple scattering, f_ss + E_ms(o) / pi: the lobe by which other renderers light from images.
// Fdez-Aguera 2019, "A Multiple-Scattering Microfacet Model for Real-Time Image-based Lighting". E_ms depends only on
// wo, so the lobe is not reciprocal; it is darker than Kulla & Conty's on rough metal that is not white.
#include "bsdf/kulla_conty.glsl"
#include "bsdf/compare/ggx.glsl"
#include "bsdf/multiscatter.glsl"

// Equation 18: E_ms = E_ss F_mean (1 - E_w) / (1 - F_mean (1 - E_w)), where E_w is E_ss with F = 1 (a + b of the split
// sum), and f0 and f90 are those of Schlick's F. Without masking E_w may exceed 1, and no light is missing.
vec3 fdez_aguera_multiple(vec3 E_ss, vec3 f0, vec3 f90, float E_w) {
    vec3 lost = f_schlick_mean(f0, f90) * max(1.0 - E_w, 0.0);
    return E_ss * lost / (1.0 - lost);
}

vec3 fdez_aguera_multiple(Ggx m, float NoV, sampler2D dfg) {
    if (is_delta(m.alpha)) return vec3(0.0);
    vec2 ab = dfg_albedo(dfg, NoV, mean_perceptual_roughness(m.alpha));
    return fdez_aguera_multiple(m.f0 * ab.x + m.f90 * ab.y, m.f0, m.f90, ab.x + ab.y);
}

vec3 fdez_aguera_eval(Ggx m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return vec3(0.0);
    return ggx_eval(m, wo, wi, dfg) + fdez_aguera_multiple(m, wo.z, dfg) * INV_PI;
}

float fdez_aguera_diffuse_probability(Ggx m, float NoV, sampler2D dfg) {
    float diffuse = luminance(fdez_aguera_multiple(m, NoV, dfg));
    return share_of(diffuse, luminance(ggx_albedo(m, NoV, dfg)));
}

float fdez_aguera_pdf(Ggx m, vec3 wo, vec3 wi, sampler2D dfg) {
    return compensated_pdf(m.alpha, fdez_aguera_diffuse_probability(m, wo.z, dfg), wo, wi);
}

BsdfSample fdez_aguera_sample(Ggx m, vec3 wo, vec3 u, sampler2D dfg) {
    float VoH;
    BsdfSample s = compensated_direction(m.alpha, fdez_aguera_diffuse_probability(m, wo.z, dfg), wo, u, VoH);
    s.weight = compensated_weight(s, fdez_aguera_eval(m, wo, s.wi, dfg), f_schlick(m.f0, m.f90, VoH));
    return s;
}

vec3 fdez_aguera_albedo(Ggx m, float NoV, sampler2D dfg) {
    return ggx_albedo(m, NoV, dfg) + fdez_aguera_multiple(m, NoV, dfg);
}
