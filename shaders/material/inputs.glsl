// Written by `python -m viewer.material` from viewer/scene/material.py; change it there.
// A material's parameters at one point of a surface, multiplied by its maps and vertex colours.
struct MaterialInputs {
    vec4 base_color;                // albedo of the diffuse base, f0 of metal, and alpha
    float metallic;                 // share of metal; the rest is dielectric
    float perceptual_roughness;     // square root of the microfacets' alpha
    vec3 emissive;                  // emitted radiance, multiplied by its strength
    float ior;                      // index of refraction of the dielectric
    float specular;                 // weight of the dielectric's reflection
    vec3 specular_color;            // tints the dielectric's f0
    float transmission;             // fraction of the light entering the dielectric that is transmitted
    float thickness;                // thickness of the volume (0: thin-walled)
    float dispersion;               // 20 over the Abbe number: how far colours are refracted apart
    float diffuse_transmission;     // fraction of the diffuse base's light that leaves on the other side
    vec3 diffuse_transmission_color; // tints the light that leaves on the other side
    float scatter_strength;         // fraction of the transmitted light that is scattered; in a volume, times the albedo of all scattering
    vec3 multiscatter_color;        // albedo of all scattering
    float multiscatter_anisotropy;  // mean cosine of scattering; of a thin wall, (1 + it) / 2 goes through
    float anisotropy_strength;      // stretches highlights along the tangent
    float anisotropy_rotation;      // rotates the direction of stretching, counter-clockwise
    float diffuse_roughness;        // roughness of the diffuse base, 0 for Lambert's
    vec3 sheen_color;               // colour of the sheen of fibres
    float sheen_roughness;          // square root of the alpha of the fibres; 0: no sheen
    float iridescence;              // weight of a thin film, at whose faces light interferes
    float iridescence_ior;          // index of refraction of the film
    float iridescence_thickness_minimum; // thickness of the film where its map is 0
    float iridescence_thickness_maximum; // thickness of the film where its map is 1, or without a map
    float clearcoat;                // weight of the clear coat's reflection
    float clearcoat_roughness;      // square root of the alpha of the clear coat's microfacets
    vec2 anisotropy_texel; // channels RG of the map
};

const MaterialInputs DEFAULT_INPUTS = MaterialInputs(
    vec4(1.0, 1.0, 1.0, 1.0), 1.0, 1.0, vec3(0.0, 0.0, 0.0), 1.5, 1.0, vec3(1.0, 1.0, 1.0), 0.0, 0.0, 0.0,
    0.0, vec3(1.0, 1.0, 1.0), 0.0, vec3(1.0, 1.0, 1.0), 0.0, 0.0, 0.0, 0.0, vec3(0.0, 0.0, 0.0), 0.0, 0.0,
    1.3, 100.0, 400.0, 0.0, 0.0, vec2(1.0, 0.5));
