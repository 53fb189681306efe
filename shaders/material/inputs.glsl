// Written by `python -m viewer.material` from viewer/scene/material.py; change it there.
// What a material is at one point: its parameters, with maps and vertex colours multiplied in.
struct MaterialInputs {
    vec4 base_color;                // albedo of the diffuse base, f0 of metal, and alpha
    float metallic;                 // share of metal; the rest is dielectric
    float perceptual_roughness;     // square root of the microfacets' alpha
    vec3 emissive;                  // emitted radiance, its strength multiplied in (W/(sr m^2))
    float ior;                      // index of refraction of the dielectric
    float specular;                 // weight of the dielectric's reflection
    vec3 specular_color;            // tints the dielectric's f0
    float transmission;             // share of what enters the dielectric that is refracted on
    float thickness;                // thickness of the volume; 0: a thin wall (mesh units)
    float anisotropy_strength;      // stretches highlights along the tangent
    float anisotropy_rotation;      // turns the direction of stretching, counter-clockwise (radians)
    vec2 anisotropy_texel; // RG of its map
};

const MaterialInputs DEFAULT_INPUTS = MaterialInputs(
    vec4(1.0, 1.0, 1.0, 1.0), 1.0, 1.0, vec3(0.0, 0.0, 0.0), 1.5, 1.0, vec3(1.0, 1.0, 1.0), 0.0, 0.0, 0.0,
    0.0, vec2(1.0, 0.5));
