// f = rho / pi                                                                        Lambert 1760, "Photometria"
#include "bsdf/bsdf.glsl"
#include "bsdf/lambert.glsl"
#include "sample/hemisphere.glsl"

struct Lambert {
    vec3 albedo;
};

vec3 lambert_eval(Lambert m, vec3 wo, vec3 wi) {
    return wo.z > 0.0 && wi.z > 0.0 ? f_lambert(m.albedo) : vec3(0.0);
}

float lambert_pdf(Lambert m, vec3 wo, vec3 wi) {
    return wo.z > 0.0 ? pdf_cosine_hemisphere(wi) : 0.0;
}

BsdfSample lambert_sample(Lambert m, vec3 wo, vec3 u) {
    vec3 wi = sample_cosine_hemisphere(u.xy);
    if (wo.z <= 0.0 || wi.z <= 0.0) return NO_SAMPLE;
    return BsdfSample(wi, m.albedo, pdf_cosine_hemisphere(wi), REFLECTION, 1.0);
}

vec3 lambert_albedo(Lambert m, float NoV) {
    return m.albedo;
}
