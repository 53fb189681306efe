// GGX (Trowbridge-Reitz 1975; Walter et al. 2007, "Microfacet Models for Refraction"), isotropic, and its Smith
// masking.
#include "bsdf/constants.glsl"

// D(h) = alpha^2 / (pi (1 + NoH^2 (alpha^2 - 1))^2), written with s2 = |n x h|^2 = 1 - NoH^2 (Lagrange's identity):
//   k = alpha / (s2 + alpha^2 NoH^2),  D = k^2 / pi
// In float32 the textbook denominator cancels near NoH = 1: its error is 42 % at alpha = 1e-3. The error of this form
// is 0.04 % at alpha = 1e-4.
float d_ggx(float NoH, float s2, float alpha) {
    float k = alpha / (s2 + alpha * alpha * NoH * NoH);
    return k * k * INV_PI;
}

// V = G2 / (4 NoV NoL), height-correlated (Heitz 2014, "Understanding the Masking-Shadowing Function", eq. 99):
//   V = 1 / (2 (NoL sqrt(alpha^2 + (1 - alpha^2) NoV^2) + NoV sqrt(alpha^2 + (1 - alpha^2) NoL^2)))
float v_smith_ggx(float NoV, float NoL, float alpha) {
    float a2 = alpha * alpha;
    float t_v = sqrt(a2 + (1.0 - a2) * NoV * NoV);
    float t_l = sqrt(a2 + (1.0 - a2) * NoL * NoL);
    return 0.5 / (NoL * t_v + NoV * t_l);
}

// Smith with independent masking and shadowing, G2 = G1(v) G1(l). It is for comparison, since it loses light.
float v_smith_separable_ggx(float NoV, float NoL, float alpha) {
    float a2 = alpha * alpha;
    float t_v = sqrt(a2 + (1.0 - a2) * NoV * NoV);
    float t_l = sqrt(a2 + (1.0 - a2) * NoL * NoL);
    return 1.0 / ((NoV + t_v) * (NoL + t_l));
}
