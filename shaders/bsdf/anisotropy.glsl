// The alphas of a material, and the direction along which it stretches highlights (KHR_materials_anisotropy).
#include "material/inputs.glsl"

// (alpha_t, alpha), along the tangent and across it: alpha_t = mix(alpha, 1, strength^2)
vec2 alphas_of(MaterialInputs m) {
    float alpha = m.perceptual_roughness * m.perceptual_roughness;
#if ANISOTROPIC
    return vec2(mix(alpha, 1.0, m.anisotropy_strength * m.anisotropy_strength), alpha);
#else
    return vec2(alpha);
#endif
}

// Of the isotropic lobe that stands for a stretched one
float mean_roughness(MaterialInputs m) {
#if ANISOTROPIC
    vec2 alphas = alphas_of(m);
    return sqrt(sqrt(alphas.x * alphas.y));
#else
    return m.perceptual_roughness;
#endif
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
