// How a lobe of a fibre spreads light along the fibre: M of d'Eon et al. 2011, "An Energy-Conserving Hair Reflectance
// Model", eq. 7. An inclination theta, from the normal plane towards the fibre's tip, is the unit vector
// (cos theta, sin theta). v is the lobe's variance, `mean` the inclination about which M lies.
#include "media/one_minus_exp.glsl"

// exp(-x) I0(x) of the modified Bessel function, x >= 0, to 3e-7: Abramowitz & Stegun 1964, 9.8.1 and 9.8.2. The
// exponential is divided out because I0 itself overflows at x = 92.
float scaled_bessel_i0(float x) {
    float t = x / 3.75;
    if (t < 1.0) {
        t *= t;
        return exp(-x) * (1.0 + t * (3.5156229 + t * (3.0899424 + t * (1.2067492
             + t * (0.2659732 + t * (0.0360768 + t * 0.0045813))))));
    }
    t = 1.0 / t;
    return (0.39894228 + t * (0.01328592 + t * (0.00225319 + t * (-0.00157565 + t * (0.00916281
         + t * (-0.02057706 + t * (0.02635537 + t * (-0.01647633 + t * 0.00392377)))))))) * inversesqrt(x);
}

// M = exp(sin theta sin mean / v) I0(cos theta cos mean / v) / (2 v sinh(1 / v)), whose integral over theta, times
// cos theta, is 1. For small v every factor overflows, so the exponentials are collected: with d the difference of the
// two unit vectors,
//   M = exp(-d^2 / 2 v) (exp(-a) I0(a)) / (v (1 - exp(-2 / v))),  a = cos theta cos mean / v
float longitudinal(vec2 theta, vec2 mean, float v) {
    vec2 d = theta - mean;
    return exp(-0.5 * dot(d, d) / v) * scaled_bessel_i0(theta.x * mean.x / v) / (v * one_minus_exp(2.0 / v));
}

// Samples M (ibid., eq. 8): M is the distribution of von Mises & Fisher about the direction `mean`, seen from the side.
// u in [0, 1)^2. The cosine of the angle to the mean direction is
//   1 + v log(r) = 1 - x,  r = u + (1 - u) exp(-2 / v) = 1 - (1 - u) (1 - exp(-2 / v))
// where the first form of r keeps the digits of a small r and the second those of a small x.
// The direction is turned as a whole, so that cos theta keeps its digits where theta is almost a right angle.
vec2 longitudinal_sample(vec2 mean, float v, vec2 u) {
    float r = u.x + (1.0 - u.x) * exp(-2.0 / v);
    float x = r < 0.5 ? -log(max(r, 1e-30)) : minus_log_one_minus((1.0 - u.x) * one_minus_exp(2.0 / v));
    x = min(v * x, 2.0);
    float across = sqrt(x * (2.0 - x)), turn = 2.0 * PI * u.y;
    vec2 side = across * vec2(cos(turn), sin(turn));
    vec2 in_plane = (1.0 - x) * mean + side.x * vec2(-mean.y, mean.x);
    return normalize(vec2(length(vec2(in_plane.x, side.y)), in_plane.y));
}
