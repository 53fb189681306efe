// A surface's material as the lobe of bsdf/lobe/standard.glsl.
#include "trace/material.glsl"
#include "bsdf/lobe/standard.glsl"

Standard standard_of(SurfaceMaterial m) {
    float f0 = f0_from_eta(m.inputs.ior);
    float alpha = m.inputs.perceptual_roughness * m.inputs.perceptual_roughness;
    return Standard(m.inputs.base_color.rgb, m.inputs.metallic, min(f0 * m.inputs.specular_color, 1.0) * m.inputs.specular, m.inputs.specular, alpha, m.inputs.ior);
}
