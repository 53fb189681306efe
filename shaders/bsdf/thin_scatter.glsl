// A thin wall that scatters what it transmits (KHR_materials_scatter without a volume), as one that transmits light
// diffusely. Of the light that enters, T is transmitted, S of that is scattered, and (1 + g) / 2 of that goes through:
//   base = (1 - T) diffuse + T (1 - S) specular + T S color / pi, (1 - g) / 2 of it above and (1 + g) / 2 below
// Afterwards scatter_strength is the share of what stays above that is scattered in the wall.
#include "material/inputs.glsl"

void apply_thin_scatter(inout MaterialInputs m) {
    float scattered = m.transmission * m.scatter_strength, kept = 1.0 - m.transmission;
    float back = 0.5 * scattered * (1.0 - m.multiscatter_anisotropy), through = scattered - back;
    m.transmission -= scattered;
    m.diffuse_transmission = through / max(kept + scattered, 1e-6);
    m.diffuse_transmission_color = m.multiscatter_color;
    m.scatter_strength = back / max(kept + back, 1e-6);
}
