// The rough diffuse base without an interface over it: Portsmouth, Kutz & Hill 2024 (bsdf/eon.glsl).
#include "bsdf/bsdf.glsl"
#include "bsdf/eon.glsl"
#include "bsdf/eon_sample.glsl"

struct Eon {
    vec3 albedo;
    float sigma;
};

vec3 eon_eval(Eon m, vec3 wo, vec3 wi) {
    return wo.z > 0.0 && wi.z > 0.0 ? f_eon(m.albedo, m.sigma, wo.z, wi.z, dot(wo, wi)) : vec3(0.0);
}

float eon_pdf(Eon m, vec3 wo, vec3 wi) {
    return wo.z > 0.0 ? pdf_eon(wo, wi, m.sigma) : 0.0;
}

BsdfSample eon_sample(Eon m, vec3 wo, vec3 u) {
    vec3 wi = sample_eon(wo, m.sigma, u.xy);
    if (wo.z <= 0.0 || wi.z <= 0.0) return NO_SAMPLE;
    float pdf = eon_pdf(m, wo, wi);
    return BsdfSample(wi, eon_eval(m, wo, wi) * (wi.z / max(pdf, 1e-30)), pdf, REFLECTION, 1.0);
}

vec3 eon_albedo(Eon m, float NoV) {
    return eon_total_albedo(m.albedo, m.sigma, NoV);
}
