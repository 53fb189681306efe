// GGX scaled to include multiple scattering, f (1 + f0 (1 - E(o)) / E(o)).
// Turquin 2019, "Practical multiple scattering compensation for microfacet models". The factor depends only on wo, so
// the lobe is not reciprocal.
#include "bsdf/compare/ggx.glsl"
#include "bsdf/multiscatter.glsl"

vec3 turquin_scale(Ggx m, float NoV, sampler2D dfg) {
    vec2 ab = dfg_albedo(dfg, NoV, mean_perceptual_roughness(m.alpha));
    return is_delta(m.alpha) ? vec3(1.0) : turquin_factor(m.f0, ab.x + ab.y);
}

vec3 turquin_eval(Ggx m, vec3 wo, vec3 wi, sampler2D dfg) {
    return ggx_eval(m, wo, wi, dfg) * turquin_scale(m, wo.z, dfg);
}

float turquin_pdf(Ggx m, vec3 wo, vec3 wi, sampler2D dfg) {
    return ggx_pdf(m, wo, wi, dfg);
}

BsdfSample turquin_sample(Ggx m, vec3 wo, vec3 u, sampler2D dfg) {
    BsdfSample s = ggx_sample(m, wo, u, dfg);
    s.weight *= turquin_scale(m, wo.z, dfg);
    return s;
}

vec3 turquin_albedo(Ggx m, float NoV, sampler2D dfg) {
    return ggx_albedo(m, NoV, dfg) * turquin_scale(m, NoV, dfg);
}
