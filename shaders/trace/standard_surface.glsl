// A surface's material as the lobe of bsdf/lobe/standard.glsl.
#include "trace/material.glsl"
#include "bsdf/lobe/standard.glsl"

Standard standard_of(SurfaceMaterial m) {
    float f0 = f0_from_eta(m.ior);
    float alpha = m.perceptual_roughness * m.perceptual_roughness;
    return Standard(m.base_color, m.metallic, min(f0 * m.specular_color, 1.0) * m.specular, m.specular, alpha, m.ior);
}
