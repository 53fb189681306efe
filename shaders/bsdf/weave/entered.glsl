// Light that enters a fibre once and leaves it: straight through, or after it was reflected inside (the lobes TT and
// TRT of Marschner et al. 2003). Both stay near a cone about the fibre. In terms of s = axis . w and the azimuth phi
// between both directions,
//   F(o, i) = 2/pi cos_o cos_i P(s_o, -s_i) N(phi),   the integral of F over all i being cos_o = sqrt(1 - s_o^2)
//   P(x, y) = sum of r^n U_n(x) U_n(y) = (1 - r^2) / ((1 - r^2)^2 - 4 r (1 + r^2) x y + 4 r^2 (x^2 + y^2))
// where U_n are the Chebyshev polynomials of the second kind, which are orthogonal with the weight 2/pi cos: so P has
// the mean 1 for every x, it is never negative, and F is reciprocal. Since P of r after P of s is P of r s, it also
// says what several fibres do. The numbers are those of Chiang et al. 2016 for an index of 1.55 and roughnesses of 0.3,
// as means over h: r from the height of their lobe M where a fibre is met at a right angle, N a power of the cosine of
// half the angle from its middle. For TRT they are 0.268 and 16. For TT they are 0.876 and 6, and those of two fibres
// in a row 0.77 and 2.5; what leaves one often crosses another, so they lie between.
#include "bsdf/constants.glsl"
#include "bsdf/weave/flakes.glsl"

const vec2 ENTERED_R = vec2(0.82, 0.268);       // TT, TRT; as in viewer/bake/entered.py
const vec2 ENTERED_SHARE = vec2(0.932, 0.068);  // of the light that white fibres do not mirror
const vec2 ENTERED_PEAK = vec2(0.58205, 1.1372);  // 1 over the integrals of the powers below

// Light is sampled as if flakes of this alpha mirrored it, and the fibre then turned half about its axis.
const float ENTERED_ALPHA = 0.4;

vec3 entered_sample(vec3 axis, vec3 wo, vec2 u) {
    vec3 h = flakes_sample(Flakes(axis, ENTERED_ALPHA), wo, u);
    vec3 wi = 2.0 * dot(wo, h) * h - wo;
    return 2.0 * dot(axis, wi) * axis - wi;
}

float entered_pdf(vec3 axis, vec3 wo, vec3 wi) {
    Flakes f = Flakes(axis, ENTERED_ALPHA);
    return flakes_mirroring(f, wo, 2.0 * dot(axis, wi) * axis - wi) / (4.0 * flakes_area(f, wo));
}

// The cosine of the azimuth about the axis between two directions
float azimuth_about(vec3 axis, vec3 wo, vec3 wi) {
    float x = dot(axis, wo), y = dot(axis, wi);
    return clamp((dot(wo, wi) - x * y) * inversesqrt(max((1.0 - x * x) * (1.0 - y * y), 1e-12)), -1.0, 1.0);
}

// F of both lobes, for white fibres; c is the cosine of the azimuth
vec2 entered_once(vec3 axis, vec3 wo, vec3 wi, float c) {
    float x = dot(axis, wo), y = -dot(axis, wi);
    float both = sqrt(max((1.0 - x * x) * (1.0 - y * y), 1e-12));
    vec2 r = ENTERED_R, r2 = r * r, q = 1.0 - r2;
    vec2 P = q / max(q * q - 4.0 * r * (1.0 + r2) * x * y + 4.0 * r2 * (x * x + y * y), 1e-6);
    float onwards = 0.5 - 0.5 * c, returned = 0.5 + 0.5 * c;
    float o2 = onwards * onwards, r4 = returned * returned * returned * returned;
    vec2 N = ENTERED_PEAK * vec2(o2 * o2, r4 * r4 * r4 * r4);
    return 2.0 * INV_PI * both * P * N * ENTERED_SHARE;
}
