// Fresnel reflectance of metals.
#include "bsdf/fresnel.glsl"

// F82-tint: Schlick's curve F_S minus a term that makes F = tint F_S at mu = 1/7 (82 degrees), where metals are
// darkest.
//   b = F_S(1/7) (1 - tint) / (1/7 (6/7)^6),  F = F_S(mu) - b mu (1 - mu)^6
// Hoffman 2019, "Fresnel Equations Considered Harmful"; Kutz, Hasan & Edmondson 2021, "Novel aspects of the Adobe
// Standard Material"
vec3 f82_dip(vec3 f0, vec3 tint) {
    return f_schlick(f0, vec3(1.0), 1.0 / 7.0) * (1.0 - tint) * (823543.0 / 46656.0); // 7 (7/6)^6
}

vec3 f_f82_tint(vec3 f0, vec3 tint, float mu) {
    float m = clamp(1.0 - mu, 0.0, 1.0);
    // For a dark f0 with a dark tint the difference would be negative.
    return max(f_schlick(f0, vec3(1.0), mu) - f82_dip(f0, tint) * (mu * pow5(m) * m), 0.0);
}

// The hemispherical mean 2 int F mu dmu = mean of F_S - b / 126
vec3 f_f82_tint_mean(vec3 f0, vec3 tint) {
    return max(f_schlick_mean(f0, vec3(1.0)) - f82_dip(f0, tint) / 126.0, 0.0);
}

// Unpolarised reflectance of a conductor with complex index eta + i k (relative to the outside), mu >= 0.
//   t = eta^2 - k^2 - s2,  w = sqrt(t^2 + 4 eta^2 k^2),  a^2 = (w + t) / 2,  b^2 = (w - t) / 2,  s2 = 1 - mu^2
//   F_s = ((a - mu)^2 + b^2) / ((a + mu)^2 + b^2)
//   F_p = F_s ((a mu - s2)^2 + b^2 mu^2) / ((a mu + s2)^2 + b^2 mu^2),   F = (F_s + F_p) / 2
// Born & Wolf 1999, section 14.2. All terms are sums of squares, so nothing cancels. The smaller one of a^2 and b^2 is
// computed from a^2 b^2 = eta^2 k^2.
float f_conductor(float mu, float eta, float k) {
    if (eta == 1.0 && k == 0.0) return 0.0; // no interface; below, a would be mu only where sqrt is exact
    k = min(k, 1e4); // keeps k^2 within float32; there 1 - F is only 4 eta 1e-8
    float s2 = 1.0 - mu * mu;
    float t = (eta - 1.0) * (eta + 1.0) + mu * mu - k * k; // eta^2 - s2 would cancel at eta = 1
    float product = eta * k;
    float w = length(vec2(t, 2.0 * product));
    float large = 0.5 * (w + abs(t));
    float small = large > 0.0 ? product * (product / large) : 0.0;
    float a = sqrt(t > 0.0 ? large : small);
    float b2 = t > 0.0 ? small : large;
    float near_s = (a - mu) * (a - mu) + b2, far_s = (a + mu) * (a + mu) + b2;
    float near_p = (a * mu - s2) * (a * mu - s2) + b2 * mu * mu, far_p = (a * mu + s2) * (a * mu + s2) + b2 * mu * mu;
    float F_s = near_s / far_s;
    return 0.5 * (F_s + F_s * (far_p > 0.0 ? near_p / far_p : 1.0));
}

vec3 f_conductor(float mu, vec3 eta, vec3 k) {
    return vec3(f_conductor(mu, eta.r, k.r), f_conductor(mu, eta.g, k.g), f_conductor(mu, eta.b, k.b));
}
