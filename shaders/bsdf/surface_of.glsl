// Converts a material's parameters to those of its BSDF.
#include "bsdf/anisotropy.glsl"
#include "bsdf/surface.glsl"

Surface surface_of(MaterialInputs m) {
    vec3 f0 = min(f0_from_eta(m.ior) * m.specular_color, 1.0) * m.specular;
    vec2 alphas = alphas_of(m);
    return Surface(m.base_color.rgb, m.metallic, f0, m.specular, m.ior, alphas.y, alphas.x,
                   m.iridescence, m.iridescence_ior, m.iridescence_thickness_maximum, 0.0, m.diffuse_roughness,
                   m.diffuse_transmission, m.diffuse_transmission_color, m.scatter_strength, m.clearcoat,
                   m.clearcoat_roughness * m.clearcoat_roughness, m.sheen_color, m.sheen_roughness);
}
