// Converts a material's parameters to those of its BSDF.
#include "bsdf/surface.glsl"
#include "material/inputs.glsl"

// KHR_materials_anisotropy: the alpha along the tangent is larger, alpha_t = mix(alpha, 1, strength^2).
Surface surface_of(MaterialInputs m) {
    vec3 f0 = min(f0_from_eta(m.ior) * m.specular_color, 1.0) * m.specular;
    float alpha = m.perceptual_roughness * m.perceptual_roughness;
    float alpha_t = mix(alpha, 1.0, m.anisotropy_strength * m.anisotropy_strength);
    return Surface(m.base_color.rgb, m.metallic, f0, m.specular, m.ior, alpha, alpha_t);
}

#if ANISOTROPIC
// The direction along which highlights are stretched, in the mesh's tangent and bitangent: the direction of the map,
// rotated counter-clockwise by anisotropy_rotation.
vec2 anisotropy_direction(MaterialInputs m) {
    vec2 d = m.anisotropy_texel * 2.0 - 1.0;
    d = dot(d, d) > 1e-12 ? normalize(d) : vec2(1.0, 0.0);
    float c = cos(m.anisotropy_rotation), s = sin(m.anisotropy_rotation);
    return vec2(c * d.x - s * d.y, s * d.x + c * d.y);
}
#endif
