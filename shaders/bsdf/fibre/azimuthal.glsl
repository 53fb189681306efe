// How a lobe of a fibre spreads light about the fibre: N of Chiang et al. 2016, "A Practical and Controllable Hair and
// Fur Model for Production Path Tracing", section 3.2: the logistic distribution of scale s, cut off at -pi and pi.
// Angles in the normal plane are unit vectors, as complex numbers: their products and quotients need no wrapping, and
// neither arc sine nor arc cosine, which lose digits at their ends and are coarse in some drivers.
#include "media/one_minus_exp.glsl"

vec2 complex_product(vec2 a, vec2 b) {
    return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

vec2 conjugate(vec2 a) {
    return vec2(a.x, -a.y);
}

// The logistic distribution keeps the share tanh(pi / 2 s) between -pi and pi. Its density, with e = exp(-|x| / s), is
// e / (s (1 + e)^2). angle = (cos x, sin x)
float azimuthal(vec2 angle, float s) {
    float x = abs(atan(angle.y, angle.x));
    float e = exp(-x / s), edge = exp(-PI / s);
    return e * (1.0 + edge) / (s * (1.0 + e) * (1.0 + e) * one_minus_exp(PI / s));
}

// The angle x whose distribution function is u in [0, 1): with w = 2 u - 1 and t = tanh(pi / 2 s),
//   x = s log((1 + w t) / (1 - w t)),  1 - |w| t = 1 - |w| + |w| (1 - t),  1 - t = 2 exp(-pi / s) / (1 + exp(-pi / s))
vec2 azimuthal_sample(float s, float u) {
    float w = abs(2.0 * u - 1.0), edge = exp(-PI / s);
    float rest = 2.0 * edge / (1.0 + edge);
    float below = (1.0 - w) + w * rest;
    float x = below > 0.0 ? min(s * log((2.0 - below) / below), PI) : PI;
    return vec2(cos(x), u < 0.5 ? -sin(x) : sin(x));
}
