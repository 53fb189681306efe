// Blinn's cosine power as a microfacet distribution (Blinn 1977; normalised as in Walter et al. 2007).
#include "bsdf/constants.glsl"

// alpha = sqrt(2 / (s + 2)), so s = 2 / alpha^2 - 2
float shininess_from_alpha(float alpha) {
    return 2.0 / (alpha * alpha) - 2.0;
}

// D(h) = (s + 2) / (2 pi) NoH^s, NoH^s = exp(s/2 log(1 - s2)) with s2 = |n x h|^2.
// log(1 - s2) needs its series where 1 - s2 would round: at alpha = 0.01, s is 2e4 and NoH alone has lost its digits.
float d_blinn_phong(float NoH, float s2, float alpha) {
    float s = shininess_from_alpha(alpha);
    float log_c2 = s2 < 0.01 ? -s2 * (1.0 + s2 * (0.5 + s2 * (1.0 / 3.0 + 0.25 * s2))) : log(max(1.0 - s2, 1e-30));
    return NoH > 0.0 ? (s + 2.0) * 0.5 * INV_PI * exp(0.5 * s * log_c2) : 0.0;
}
