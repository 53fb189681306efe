// Energy-preserving Oren-Nayar (EON), sigma in [0, 1]: a rough diffuse surface with multiple scattering.
//   f_ss = rho / pi A (1 + sigma s / t),   A = 1 / (1 + (1/2 - 2 / (3 pi)) sigma)
//   s = wi.wo - NoL NoV,   t = s > 0 ? max(NoL, NoV) : 1
//   f_ms = rho_ms / pi (1 - E(o)) (1 - E(i)) / (1 - E_mean),   rho_ms = rho^2 E_mean / (1 - rho (1 - E_mean))
// Portsmouth, Kutz & Hill 2024, "EON: A Practical Energy-Preserving Rough Diffuse BRDF", eqs. 13 to 29. For rho = 1 its
// albedo is 1, and for sigma = 0 it is Lambert's.
#include "bsdf/constants.glsl"

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

// rho_ms
vec3 eon_multiple_albedo(vec3 rho, float sigma) {
    float E_mean = eon_mean_albedo(sigma);
    return rho * rho * E_mean / (1.0 - rho * (1.0 - E_mean));
}

// The directional albedo
vec3 eon_total_albedo(vec3 rho, float sigma, float mu) {
    if (sigma == 0.0) return rho;
    float E = eon_single_albedo(mu, sigma);
    return rho * E + eon_multiple_albedo(rho, sigma) * (1.0 - E);
}

// f; both cosines are positive
vec3 f_eon(vec3 rho, float sigma, float NoV, float NoL, float LoV) {
    float s = LoV - NoL * NoV;
    float s_over_t = s > 0.0 ? s / max(NoL, NoV) : s;
    vec3 f = rho * eon_scale(sigma) * (1.0 + sigma * s_over_t);
    if (sigma > 1e-4) { // below that 1 - E_mean is too inexact, and f_ms is less than 1e-5
        float lost_o = 1.0 - eon_single_albedo(NoV, sigma), lost_i = 1.0 - eon_single_albedo(NoL, sigma);
        f += eon_multiple_albedo(rho, sigma) * max(lost_o * lost_i / (1.0 - eon_mean_albedo(sigma)), 0.0);
    }
    return f * INV_PI;
}
