// Anisotropic GGX in the local frame: z is the normal, x the tangent; alpha = (alpha_t, alpha_b). ggx.glsl is the
// isotropic case, for shaders without a tangent.
#include "bsdf/constants.glsl"

// D(h) = 1 / (pi alpha_t alpha_b q^2),  q = (hx / alpha_t)^2 + (hy / alpha_b)^2 + hz^2
// Trowbridge & Reitz 1975; Walter et al. 2007. It is a sum of squares, so nothing cancels.
float d_ggx_local(vec3 h, vec2 alpha) {
    vec2 s = h.xy / alpha;
    float q = dot(s, s) + h.z * h.z;
    return INV_PI / ((alpha.x * q) * (alpha.y * q));
}

// Smith's functions, with the length T of the stretched direction (Heitz 2014, "Understanding the Masking-Shadowing
// Function", eqs. 72 and 86):   T(w) = sqrt(alpha_t^2 wx^2 + alpha_b^2 wy^2 + wz^2),   Lambda = (T / |wz| - 1) / 2
float smith_t(vec3 w, vec2 alpha) {
    return length(vec3(alpha * w.xy, w.z));
}

// Lambda. T - |wz| is computed as (T^2 - wz^2) / (T + |wz|), which does not cancel.
float lambda_ggx_local(vec3 w, vec2 alpha) {
    vec2 s = alpha * w.xy;
    float z = max(abs(w.z), 1e-18); // keeps the result below 1e38 at grazing angles
    return 0.5 * dot(s, s) / (z * (smith_t(w, alpha) + z));
}

// V = G2 / (4 NoV NoL), height-correlated, for two directions on the same side (Heitz 2014, eq. 99):
//   V = 1 / (2 (T_o NoL + T_i NoV))
float v_smith_ggx_local(vec3 wo, vec3 wi, vec2 alpha) {
    return 0.5 / (smith_t(wo, alpha) * wi.z + smith_t(wi, alpha) * wo.z);
}
