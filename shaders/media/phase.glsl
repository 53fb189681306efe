// The phase function of Henyey & Greenstein 1941: the density, by solid angle, of the direction in which scattered
// light travels on. mu is the cosine between the directions of travel before and after: 1 is straight on, -1 is back.
// g is the mean of mu, |g| <= 0.99.
#include "bsdf/constants.glsl"
#include "sample/one_minus_cosine.glsl"
#include "sample/orthonormal_basis.glsl"

// (1 - g^2) / (4 pi (1 + g^2 - 2 g mu)^(3/2)) for g >= 0 and x = 1 - mu. The denominator is written as
// (1 - g)^2 + 2 g x, two terms of one sign, which keeps the digits of the peak.
float henyey_greenstein(float g, float x) {
    float t2 = (1.0 - g) * (1.0 - g) + 2.0 * g * x;
    return 0.25 * INV_PI * (1.0 - g) * (1.0 + g) / (t2 * sqrt(t2));
}

float phase_eval(float g, float mu) {
    return henyey_greenstein(abs(g), g < 0.0 ? 1.0 + mu : 1.0 - mu);
}

// As phase_eval, of the two directions of travel; it keeps the digits of small angles.
float phase_between(float g, vec3 before, vec3 after) {
    return henyey_greenstein(abs(g), one_minus_cosine(g < 0.0 ? -before : before, after));
}

// The direction at an angle from `axis`, from 1 - cos and sin of the angle, and u in [0, 1) for the turn
vec3 direction_about(vec3 axis, float one_minus_cos, float sine, float u) {
    float turn = 2.0 * PI * u;
    mat3 frame = orthonormal_basis(axis);
    vec3 across = cos(turn) * frame[0] + sin(turn) * frame[1];
    return normalize(axis - one_minus_cos * axis + sine * across);
}

// Samples phase_eval about the direction of travel; u in [0, 1)^2. The inverse of the distribution (Witt 1977) is
//   mu = (1 + g^2 - ((1 - g^2) / d)^2) / 2 g,  d = 1 - g + 2 g u
// which is 0 / 0 at g = 0. From it follow, for g >= 0,
//   1 - mu = 2 (1 - g)^2 (1 - u) (1 + g u) / d^2
//   1 + mu = 2 (1 + g)^2 u (1 - g + g u) / d^2
// whose factors are sums of one sign: all digits are kept at every g. A negative g mirrors the direction.
vec3 phase_sample(float g, vec3 direction, vec2 u) {
    float a = abs(g);
    float d = 1.0 - a + 2.0 * a * u.x;
    float x = 2.0 * (1.0 - a) * (1.0 - a) * (1.0 - u.x) * (1.0 + a * u.x) / (d * d);
    float sine = 2.0 * (1.0 - a) * (1.0 + a) / (d * d)
               * sqrt(u.x * (1.0 - u.x) * (1.0 + a * u.x) * (1.0 - a + a * u.x));
    return direction_about(g < 0.0 ? -direction : direction, x, sine, u.y);
}
