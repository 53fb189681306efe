// Light of lights that a volume scatters many times, where it is too dense for the coarse grid of lit_media.glsl: close
// below a face there, light comes back after fewer steps than a cell has. The medium is taken for a half-space there.
//
// Under light of the irradiance E across it, at the cosine mu, the radiance that leaves the face at the cosine nu of
// what was scattered more than once is (Chandrasekhar 1960, section 34; isotropic scattering of the albedo a)
//   a E / (4 pi) mu / (mu + nu) (H(mu) H(nu) - 1)
// This is a / (4 pi) times the Laplace transform at 1 / nu, over nu, of the fluence phi at the optical depth z below
// the face. With H(mu) = (1 + 2 mu) / (1 + 2 mu y), y^2 = 1 - a (Hapke 1981, Bidirectional reflectance spectroscopy),
//   phi / E = (H(mu) - 1) e^(-z / mu) + 2 H(mu) (1 - y) z e^(-2 y z) f((1 / mu - 2 y) z),   f(x) = (1 - e^-x) / x
// which has no pole at 2 y mu = 1. Other phase functions are taken for isotropic ones of the reduced extinction.
#include "media/one_minus_exp.glsl"

// Of x above -80
float mean_of_exp(float x) {
    return abs(x) < 1e-3 ? 1.0 - 0.5 * x : (x > 0.0 ? one_minus_exp(x) : 1.0 - exp(-x)) / x;
}

// phi / E
float half_space_fluence(float albedo, float g, float mu, float depth) {
    float reduced = 1.0 - albedo * g, z = reduced * depth;
    float y = sqrt(max((1.0 - albedo) / reduced, 0.0)), h = (1.0 + 2.0 * mu) / (1.0 + 2.0 * mu * y);
    float later = 2.0 * h * (1.0 - y) * z * exp(-2.0 * y * z) * mean_of_exp((1.0 / mu - 2.0 * y) * z);
    return (h - 1.0) * exp(-z / mu) + later;
}

// The share of a point's scattered light that comes of this, by the optical depth of a cell of the grid
float beyond_grid(float depth_of_cell) {
    return smoothstep(1.0, 4.0, depth_of_cell);
}
