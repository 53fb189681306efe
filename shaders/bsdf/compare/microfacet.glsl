// Isotropic single scattering, f = D V F, with any distribution and masking of microfacet.glsl (NDF, MASKING) and
// Schlick's F. It is for comparison; the light of multiple scattering is lost.
#include "bsdf/bsdf.glsl"
#include "bsdf/fresnel.glsl"
#include "bsdf/half_vector.glsl"
#include "light/dfg.glsl"

struct Microfacet {
    vec3 f0;
    vec3 f90;
    float alpha;
};

vec3 microfacet_eval(Microfacet m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || wi.z <= 0.0 || m.alpha < DELTA_ALPHA) return vec3(0.0);
    vec3 h = normalize(wo + wi);
    float VoH = clamp(dot(wo, h), 0.0, 1.0);
    float dv = d_microfacet(h.z, dot(h.xy, h.xy), m.alpha) * v_microfacet(wo.z, wi.z, h.z, VoH, m.alpha);
    return dv * f_schlick(m.f0, m.f90, VoH);
}

float microfacet_pdf(Microfacet m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || wi.z <= 0.0 || m.alpha < DELTA_ALPHA) return 0.0;
    return pdf_half_reflection(wo, normalize(wo + wi), m.alpha);
}

BsdfSample microfacet_sample(Microfacet m, vec3 wo, vec3 u, sampler2D dfg) {
    if (wo.z <= 0.0) return NO_SAMPLE;
    if (m.alpha < DELTA_ALPHA) {
        return BsdfSample(vec3(-wo.xy, wo.z), f_schlick(m.f0, m.f90, wo.z), 1.0, REFLECTION | DELTA, 1.0);
    }
    vec3 h = sample_half(wo, m.alpha, u.xy);
    float VoH = dot(wo, h);
    vec3 wi = normalize(2.0 * VoH * h - wo);
    if (wi.z <= 0.0 || VoH <= 0.0) return NO_SAMPLE;
    float pdf = pdf_half_reflection(wo, h, m.alpha);
    float d_over_pdf = d_microfacet(h.z, dot(h.xy, h.xy), m.alpha) / max(pdf, 1e-30);
    float v = v_microfacet(wo.z, wi.z, h.z, VoH, m.alpha);
    return BsdfSample(wi, f_schlick(m.f0, m.f90, VoH) * (d_over_pdf * v * wi.z), pdf, REFLECTION, 1.0);
}

// f0 a + f90 b, from the table of this NDF and MASKING
vec3 microfacet_albedo(Microfacet m, float NoV, sampler2D dfg) {
    vec2 ab = dfg_albedo(dfg, NoV, sqrt(m.alpha));
    return m.f0 * ab.x + m.f90 * ab.y;
}
