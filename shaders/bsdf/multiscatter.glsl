// Multiple scattering: light that leaves a rough surface after several bounces between its microfacets. Single
// scattering alone loses 8, 31 and 69 % of the light (white GGX, normal view, alpha 0.25, 0.5, 1).
#include "bsdf/fresnel.glsl"

// The fraction of the light missing in single scattering that leaves after several bounces, with
// mean_loss = 1 - E_mean. It is the same for both directions, so the lobe is reciprocal.
//   F_mean^2 E_mean / (1 - F_mean (1 - E_mean))       Kulla & Conty 2017, with the Fresnel factor of Hill 2018
vec3 kulla_conty_fresnel(vec3 F_mean, float mean_loss) {
    return F_mean * F_mean * (1.0 - mean_loss) / (1.0 - F_mean * mean_loss);
}

// Multiple scattering as a factor that depends only on the viewer's direction: f_total = f * turquin_factor
// Turquin 2019, "Practical multiple scattering compensation"
vec3 turquin_factor(vec3 f0, float E_w) {
    return 1.0 + f0 * (max(1.0 - E_w, 0.0) / max(E_w, 1e-3));
}
