// Of the light that falls on a thin wall at the cosine mu, what goes on behind it, but for the wall's tint: with the
// reflectance of both faces together, 2 R / (1 + R).
#include "bsdf/fresnel.glsl"

float straight_through(MaterialInputs m, float mu) {
    float R = m.specular * f_dielectric(mu, m.ior);
    return m.transmission * (1.0 - m.metallic) * (1.0 - 2.0 * R / (1.0 + R));
}
