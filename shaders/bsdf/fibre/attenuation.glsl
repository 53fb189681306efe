// What a fibre lets through: A_p of d'Eon et al. 2011, section 4.1, and of Chiang et al. 2016, section 3.3 for all
// p >= 3 together. The fibre is a dielectric cylinder of radius 1. Light enters at the offset h and crosses it p times;
// p = 0 is reflected outside (R), 1 crosses it once (TT), 2 is reflected inside once (TRT).
#include "bsdf/fresnel.glsl"
#include "media/one_minus_exp.glsl"

// 1 - f_dielectric without the difference, which has no digits left where nearly all is reflected:
//   1 - F = 2 mu g (1 / (mu + g)^2 + eta^2 / (eta^2 mu + g)^2)
float fresnel_transmittance(float mu, float eta) {
    float g = sqrt(max((eta - 1.0) * (eta + 1.0) + mu * mu, 0.0));
    if (mu + g <= 0.0) return eta == 1.0 ? 1.0 : 0.0;
    float s = 1.0 / (mu + g), p = eta / (eta * eta * mu + g);
    return 2.0 * mu * g * (s * s + p * p);
}

// The way through the fibre, as it is seen along its axis, by the offset inside: sin of the angle of refraction and
// cos, and `way`, the length between two meetings with the wall in radii. theta is as in longitudinal.glsl. Snell's law
// has the index eta' = sqrt(eta^2 - sin^2 theta) / cos theta along the axis (Marschner et al. 2003, eq. 4). The
// differences of squares are written as sums, or nothing is left of them where eta = 1 or |h| = 1:
//   eta^2 - sin^2 theta = (eta^2 - 1) + cos^2 theta = q,   sin gamma_t = h cos theta / sqrt(q)
//   cos gamma_t = sqrt((eta^2 - 1) + cos^2 theta (1 - h^2)) / sqrt(q),   way = 2 cos gamma_t / (sqrt(q) / eta)
struct FibreWay { vec2 gamma_t; float way; };

FibreWay fibre_way(float h, float cos_theta, float eta) {
    float delta = (eta - 1.0) * (eta + 1.0);
    float c2 = cos_theta * cos_theta;
    float q = delta + c2;
    vec2 gamma_o = vec2(sqrt((1.0 - h) * (1.0 + h)), h);
    if (q < 1e-20) return FibreWay(gamma_o, 2e10 * gamma_o.x); // eta = 1 along the fibre: straight on, and for ever
    float inverse = inversesqrt(q);
    vec2 gamma_t = vec2(sqrt(delta + c2 * gamma_o.x * gamma_o.x), h * cos_theta) * inverse;
    return FibreWay(gamma_t, 2.0 * eta * gamma_t.x * inverse);
}

// A_0 to A_3, one a column; the last is the sum of all p >= 3. With T = exp(-sigma_a way) and F at the wall,
//   A_0 = F,  A_1 = (1 - F)^2 T,  A_2 = A_1 F T,  A_3 = A_2 F T / (1 - F T)
// The denominator is (1 - F) + F (1 - T), which keeps its digits; without absorption A_3 is (1 - F) F^2 even where F =
// 1.
mat4x3 fibre_attenuation(vec3 sigma_a, float way, float mu, float eta) {
    float F = f_dielectric(mu, eta), t = fresnel_transmittance(mu, eta);
    vec3 depth = sigma_a * way;
    vec3 T = exp(-depth);
    vec3 rest = t + F * one_minus_exp(depth);
    vec3 share = t / max(rest, vec3(1e-30)); // at most 1
    return mat4x3(vec3(F), t * t * T, t * t * F * T * T, t * F * F * T * T * T * share);
}
