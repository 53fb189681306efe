// Single scattering, f = D V F with GGX, height-correlated Smith and Schlick's F. The light of multiple scattering is
// lost: 8, 31 and 69 % for a white surface of alpha 0.25, 0.5 and 1, seen along the normal.
#include "bsdf/fresnel.glsl"
#include "bsdf/ggx_reflection.glsl"

struct Ggx {
    vec3 f0;
    vec3 f90;
    vec2 alpha; // along the tangent, across it
};

vec3 ggx_eval(Ggx m, vec3 wo, vec3 wi, sampler2D dfg) {
    float VoH;
    float dv = ggx_reflection(m.alpha, wo, wi, VoH);
    return dv * f_schlick(m.f0, m.f90, VoH);
}

float ggx_pdf(Ggx m, vec3 wo, vec3 wi, sampler2D dfg) {
    return ggx_reflection_pdf(m.alpha, wo, wi);
}

BsdfSample ggx_sample(Ggx m, vec3 wo, vec3 u, sampler2D dfg) {
    float VoH;
    BsdfSample s = ggx_reflection_sample(m.alpha, wo, u.xy, VoH);
    s.weight *= f_schlick(m.f0, m.f90, VoH);
    return s;
}

// f0 a + f90 b
vec3 ggx_albedo(Ggx m, float NoV, sampler2D dfg) {
    vec2 ab = dfg_albedo(dfg, NoV, mean_perceptual_roughness(m.alpha));
    return m.f0 * ab.x + m.f90 * ab.y;
}
