// Blinn's cosine power as a microfacet distribution (Blinn 1977; normalised as in Walter et al. 2007).
#include "bsdf/constants.glsl"

// alpha = sqrt(2 / (s + 2)), so s = 2 / alpha^2 - 2
float shininess_from_alpha(float alpha) {
    return 2.0 / (alpha * alpha) - 2.0;
}

// D(h) = (s + 2) / (2 pi) NoH^s, NoH^s = exp(s/2 log(1 - s2)) with s2 = |n x h|^2.
// Rounding 1 - s2 (or NoH) would cause an error that s multiplies: at alpha = 0.01, s is 2e4. So log(1 - s2) is
// computed as -2 artanh(t), t = s2 / (2 - s2), by its series, whose remainder is below the rounding error here.
float d_blinn_phong(float NoH, float s2, float alpha) {
    float s = shininess_from_alpha(alpha);
    float t = s2 / (2.0 - s2);
    float t2 = t * t;
    float series = -2.0 * t * (1.0 + t2 * (1.0 / 3.0 + t2 * (0.2 + t2 * (1.0 / 7.0 + t2 / 9.0))));
    float log_c2 = s2 < 0.25 ? series : log(max(1.0 - s2, 1e-30));
    return NoH > 0.0 ? (s + 2.0) * 0.5 * INV_PI * exp(0.5 * s * log_c2) : 0.0;
}
