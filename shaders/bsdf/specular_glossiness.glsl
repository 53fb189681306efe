// A material with a map of specular and glossiness, as a dielectric of metallic-roughness:
//   f0 = specular * texel.rgb,   roughness = 1 - glossiness * texel.a,   albedo = diffuse (1 - max(f0)),   f90 = 1
// KHR_materials_pbrSpecularGlossiness, appendix B. specular is the f0 of the index times specular_color, glossiness is
// 1 - perceptual_roughness, and diffuse is the base colour, whose own map may be applied before or after.
#include "bsdf/fresnel.glsl"
#include "material/inputs.glsl"

void apply_specular_glossiness(inout MaterialInputs m, vec4 texel) {
    m.specular_color *= texel.rgb;
    m.perceptual_roughness = 1.0 - (1.0 - m.perceptual_roughness) * texel.a;
    vec3 f0 = min(f0_from_eta(m.ior) * m.specular_color, 1.0);
    m.base_color.rgb *= 1.0 - max(f0.r, max(f0.g, f0.b));
}
