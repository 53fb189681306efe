// Energy-preserving Oren-Nayar (EON), sigma in [0, 1]: a rough diffuse surface with multiple scattering.
//   f_ss = rho / pi A (1 + sigma s / t),   A = 1 / (1 + (1/2 - 2 / (3 pi)) sigma)
//   s = wi.wo - NoL NoV,   t = s > 0 ? max(NoL, NoV) : 1
//   f_ms = rho_ms / pi (1 - E(o)) (1 - E(i)) / (1 - E_mean),   rho_ms = rho^2 E_mean / (1 - rho (1 - E_mean))
// Portsmouth, Kutz & Hill 2024, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", eqs. 13 to 29. For rho = 1 its
// albedo is 1.
#include "bsdf/bsdf.glsl"
#include "sample/hemisphere.glsl"

struct Eon {
    vec3 albedo;
    float sigma;
};

float eon_scale(float sigma) {
    return 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * PI)) * sigma);
}

// E(mu) = A (1 + sigma G / pi),  G = sin (theta - sin cos) + 2/3 (tan (1 - sin^3) - sin).
// It is computed with tan (1 - sin^3) = sin cos (1 + sin + sin^2) / (1 + sin), since tan is infinite at grazing angles.
float eon_single_albedo(float mu, float sigma) {
    float s = sqrt(max(1.0 - mu * mu, 0.0));
    float theta = atan(s, mu);
    float G = s * (theta - s * mu) + (2.0 / 3.0) * (s * mu * (1.0 + s + s * s) / (1.0 + s) - s);
    return eon_scale(sigma) * (1.0 + sigma * INV_PI * G);
}

float eon_mean_albedo(float sigma) {
    return eon_scale(sigma) * (1.0 + sigma * (2.0 / 3.0 - 28.0 / (15.0 * PI)));
}

vec3 eon_multiple_albedo(Eon m) {
    float E_mean = eon_mean_albedo(m.sigma);
    return m.albedo * m.albedo * E_mean / (1.0 - m.albedo * (1.0 - E_mean));
}

vec3 eon_eval(Eon m, vec3 wo, vec3 wi) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return vec3(0.0);
    float s = dot(wo.xy, wi.xy);
    float s_over_t = s > 0.0 ? s / max(wo.z, wi.z) : s;
    vec3 f = m.albedo * eon_scale(m.sigma) * (1.0 + m.sigma * s_over_t);
    if (m.sigma > 1e-4) { // below that 1 - E_mean is too inexact, and f_ms is less than 1e-5
        float lost_o = 1.0 - eon_single_albedo(wo.z, m.sigma), lost_i = 1.0 - eon_single_albedo(wi.z, m.sigma);
        f += eon_multiple_albedo(m) * max(lost_o * lost_i / (1.0 - eon_mean_albedo(m.sigma)), 0.0);
    }
    return f * INV_PI;
}

float eon_pdf(Eon m, vec3 wo, vec3 wi) {
    return wo.z > 0.0 ? pdf_cosine_hemisphere(wi) : 0.0;
}

BsdfSample eon_sample(Eon m, vec3 wo, vec3 u) {
    vec3 wi = sample_cosine_hemisphere(u.xy);
    if (wo.z <= 0.0 || wi.z <= 0.0) return NO_SAMPLE;
    return BsdfSample(wi, PI * eon_eval(m, wo, wi), pdf_cosine_hemisphere(wi), REFLECTION, 1.0);
}

vec3 eon_albedo(Eon m, float NoV) {
    float E = eon_single_albedo(NoV, m.sigma);
    return m.albedo * E + eon_multiple_albedo(m) * (1.0 - E);
}
