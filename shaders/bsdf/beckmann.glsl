// Beckmann's distribution (Beckmann & Spizzichino 1963; Walter et al. 2007) and its Smith masking.
#include "bsdf/constants.glsl"

// D(h) = exp(-tan^2 / alpha^2) / (pi alpha^2 NoH^4), with tan^2 = s2 / NoH^2 and s2 = |n x h|^2 so that nothing
// cancels.
float d_beckmann(float NoH, float s2, float alpha) {
    float c2 = max(NoH * NoH, 1e-8); // keeps tan^2 finite for h perpendicular to n, where D is 0 anyway
    return exp(-s2 / (c2 * alpha * alpha)) * INV_PI / (alpha * alpha * c2 * c2);
}

// Smith's Lambda as the rational fit of Walter et al. 2007 (eq. 15 as Lambda = 1 / G1 - 1), 0.35 % at worst.
float lambda_beckmann(float mu, float alpha) {
    float a = mu / (alpha * sqrt(max(1.0 - mu * mu, 1e-12)));
    return a < 1.6 ? (1.0 + a * (0.396 * a - 1.259)) / (a * (3.535 + 2.181 * a)) : 0.0;
}

// V = G2 / (4 NoV NoL), height-correlated G2 = 1 / (1 + Lambda_v + Lambda_l)
float v_smith_beckmann(float NoV, float NoL, float alpha) {
    return 0.25 / (NoV * NoL * (1.0 + lambda_beckmann(NoV, alpha) + lambda_beckmann(NoL, alpha)));
}

float v_smith_separable_beckmann(float NoV, float NoL, float alpha) {
    return 0.25 / (NoV * NoL * (1.0 + lambda_beckmann(NoV, alpha)) * (1.0 + lambda_beckmann(NoL, alpha)));
}
