// Light of lights that a volume scatters many times, where it is too dense for the coarse grid of lit_media.glsl: close
// below a face there, light comes back after fewer steps than a cell has. The medium is taken for a half-space there.
//
// The fluence phi of light that has been scattered, in units of the optical depth z below the face, obeys
//   -D phi'' + (1 - a) phi = a (1 + 3 D g) E e^(-z / mu),  D = 1 / (3 (1 - a g)),   phi + 2 J = 0 at the face
// with J = -D phi' + 3 D g a mu E e^(-z / mu) its flux, a the albedo, and E the irradiance across light that arrives at
// the cosine mu (Ishimaru 1978, chapter 9; viewer/bake/diffusion.py has the same equation). With k^2 = (1 - a) / D,
//   phi / E = e^(-k z) (2 D (s / (1 + k mu) - 3 g a mu) / (1 + 2 D k) + s z f((1 / mu - k) z) / (1 + k mu))
//   s = 3 a mu (1 + g (1 - a)),   f(x) = (1 - e^-x) / x
// which has no pole at k mu = 1.
#include "media/one_minus_exp.glsl"

// Of x above -80
float mean_of_exp(float x) {
    return abs(x) < 1e-3 ? 1.0 - 0.5 * x : (x > 0.0 ? one_minus_exp(x) : 1.0 - exp(-x)) / x;
}

// phi / E, without what diffusion makes negative of a narrow peak
float half_space_fluence(float albedo, float g, float mu, float depth) {
    float D = 1.0 / (3.0 * (1.0 - albedo * g)), k = sqrt((1.0 - albedo) / D);
    float s = 3.0 * albedo * mu * (1.0 + g * (1.0 - albedo)), along = 1.0 + k * mu;
    float first = 2.0 * D * max(s / along - 3.0 * g * albedo * mu, 0.0) / (1.0 + 2.0 * D * k);
    return exp(-k * depth) * (first + s * depth * mean_of_exp((1.0 / mu - k) * depth) / along);
}

// The share of a point's scattered light that comes of this, by the optical depth of a cell of the grid
float beyond_grid(float depth_of_cell) {
    return smoothstep(1.0, 4.0, depth_of_cell);
}
