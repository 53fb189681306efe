// Written by `python -m viewer.material` from viewer/scene/material.py; change it there.
// Reads a material for the path tracer, from the scene buffer (viewer/material/pack.py).
#include "material/inputs.glsl"
#include "trace/scene_buffer.glsl"
#if HAS_TEXTURES
#include "trace/atlas.glsl"
#endif
#if SPECULAR_GLOSSINESS
#include "bsdf/specular_glossiness.glsl"
#endif
#if IRIDESCENT
#include "bsdf/iridescence_thickness.glsl"
#endif
#if THIN_SCATTER
#include "bsdf/thin_scatter.glsl"
#endif

uniform int u_materials;

const uint BASE_COLOR_ROLE = 1u, EMISSIVE_ROLE = 2u, SPECULAR_COLOR_ROLE = 4u, SPECULAR_GLOSSINESS_ROLE = 8u, DIFFUSE_TRANSMISSION_COLOR_ROLE = 16u, MULTISCATTER_COLOR_ROLE = 32u, SHEEN_COLOR_ROLE = 64u;
const uint METALLIC_ROUGHNESS_ROLE = 1u, SPECULAR_ROLE = 2u, TRANSMISSION_ROLE = 4u, DIFFUSE_TRANSMISSION_ROLE = 8u, SCATTER_STRENGTH_ROLE = 16u, ANISOTROPY_ROLE = 32u, DIFFUSE_ROUGHNESS_ROLE = 64u, SHEEN_ROUGHNESS_ROLE = 128u, IRIDESCENCE_ROLE = 256u, IRIDESCENCE_THICKNESS_ROLE = 512u, CLEARCOAT_ROLE = 1024u, CLEARCOAT_ROUGHNESS_ROLE = 2048u;

int material_texel(int material, int part) {
    return u_materials + material * 12 + part;
}

vec4 base_color_factor(int material) {
    return scene_float4(material_texel(material, 0)).xyzw;
}

float metallic_factor(int material) {
    return scene_float4(material_texel(material, 1)).x;
}

float perceptual_roughness_factor(int material) {
    return scene_float4(material_texel(material, 1)).y;
}

float ior_factor(int material) {
    return scene_float4(material_texel(material, 1)).z;
}

float specular_factor(int material) {
    return scene_float4(material_texel(material, 1)).w;
}

float normal_scale_factor(int material) {
    return scene_float4(material_texel(material, 2)).x;
}

vec3 emissive_factor(int material) {
    return scene_float4(material_texel(material, 2)).yzw;
}

vec3 specular_color_factor(int material) {
    return scene_float4(material_texel(material, 3)).xyz;
}

float transmission_factor(int material) {
    return scene_float4(material_texel(material, 3)).w;
}

float dispersion_factor(int material) {
    return scene_float4(material_texel(material, 4)).x;
}

float diffuse_transmission_factor(int material) {
    return scene_float4(material_texel(material, 4)).y;
}

vec3 diffuse_transmission_color_factor(int material) {
    return scene_float4(material_texel(material, 5)).xyz;
}

float scatter_strength_factor(int material) {
    return scene_float4(material_texel(material, 4)).z;
}

vec3 multiscatter_color_factor(int material) {
    return scene_float4(material_texel(material, 6)).xyz;
}

float multiscatter_anisotropy_factor(int material) {
    return scene_float4(material_texel(material, 4)).w;
}

float anisotropy_strength_factor(int material) {
    return scene_float4(material_texel(material, 5)).w;
}

float anisotropy_rotation_factor(int material) {
    return scene_float4(material_texel(material, 6)).w;
}

float diffuse_roughness_factor(int material) {
    return scene_float4(material_texel(material, 7)).x;
}

vec3 sheen_color_factor(int material) {
    return scene_float4(material_texel(material, 7)).yzw;
}

float sheen_roughness_factor(int material) {
    return scene_float4(material_texel(material, 8)).x;
}

float iridescence_factor(int material) {
    return scene_float4(material_texel(material, 8)).y;
}

float iridescence_ior_factor(int material) {
    return scene_float4(material_texel(material, 8)).z;
}

float iridescence_thickness_minimum_factor(int material) {
    return scene_float4(material_texel(material, 8)).w;
}

float iridescence_thickness_maximum_factor(int material) {
    return scene_float4(material_texel(material, 9)).x;
}

float clearcoat_factor(int material) {
    return scene_float4(material_texel(material, 9)).y;
}

float clearcoat_roughness_factor(int material) {
    return scene_float4(material_texel(material, 9)).z;
}

float clearcoat_normal_scale_factor(int material) {
    return scene_float4(material_texel(material, 9)).w;
}

float alpha_cutoff_factor(int material) {
    return scene_float4(material_texel(material, 10)).x;
}

// The records of the material's maps: x colour maps and y data maps, as index of the first record |
// number of records << 24; z that of the normal map + 1, w that of the coat's normal map + 1, or 0
uvec4 map_records(int material) {
    return scene_uint4(material_texel(material, 11));
}

// `color` is the interpolated vertex colour.
MaterialInputs read_inputs(int material, vec4 color, vec2 uv0, vec2 uv1) {
    MaterialInputs m = DEFAULT_INPUTS;
    m.base_color = base_color_factor(material);
#if HAS_EMISSION
    m.emissive = emissive_factor(material);
#endif
    m.metallic = metallic_factor(material);
    m.perceptual_roughness = perceptual_roughness_factor(material);
    m.ior = ior_factor(material);
    m.specular = specular_factor(material);
#if ANISOTROPIC
    m.anisotropy_strength = anisotropy_strength_factor(material);
    m.anisotropy_rotation = anisotropy_rotation_factor(material);
#endif
#if CLEARCOAT
    m.clearcoat = clearcoat_factor(material);
    m.clearcoat_roughness = clearcoat_roughness_factor(material);
#endif
#if DIFFUSE_ROUGH
    m.diffuse_roughness = diffuse_roughness_factor(material);
#endif
#if DIFFUSE_TRANSMISSION
    m.diffuse_transmission = diffuse_transmission_factor(material);
    m.diffuse_transmission_color = diffuse_transmission_color_factor(material);
#endif
#if DISPERSIVE
    m.dispersion = dispersion_factor(material);
#endif
#if HAS_TRANSMISSION
    m.transmission = transmission_factor(material);
#endif
#if IRIDESCENT
    m.iridescence = iridescence_factor(material);
    m.iridescence_ior = iridescence_ior_factor(material);
    m.iridescence_thickness_minimum = iridescence_thickness_minimum_factor(material);
    m.iridescence_thickness_maximum = iridescence_thickness_maximum_factor(material);
#endif
#if SHEEN
    m.sheen_color = sheen_color_factor(material);
    m.sheen_roughness = sheen_roughness_factor(material);
#endif
#if SPECULAR_TINTED
    m.specular_color = specular_color_factor(material);
#endif
#if THIN_SCATTER
    m.scatter_strength = scatter_strength_factor(material);
    m.multiscatter_color = multiscatter_color_factor(material);
    m.multiscatter_anisotropy = multiscatter_anisotropy_factor(material);
#endif
    m.base_color *= color;
#if HAS_TEXTURES
    uvec4 maps = map_records(material);
#endif
#if HAS_COLOR_MAPS
    int color_map = int(maps.x & 0xffffffu);
    int color_end = color_map + int(maps.x >> 24);
    if (color_map < color_end) do {
        TextureMap map = texture_map(color_map, uv0, uv1);
        vec4 texel = sample_atlas(u_color_atlas, map);
        if (has_role(map, BASE_COLOR_ROLE)) {
            m.base_color *= texel.rgba;
        }
#if HAS_EMISSION
        if (has_role(map, EMISSIVE_ROLE)) {
            m.emissive *= texel.rgb;
        }
#endif
#if SPECULAR_TINTED
        if (has_role(map, SPECULAR_COLOR_ROLE)) {
            m.specular_color *= texel.rgb;
        }
#endif
#if SPECULAR_GLOSSINESS
        if (has_role(map, SPECULAR_GLOSSINESS_ROLE)) {
            apply_specular_glossiness(m, texel);
        }
#endif
#if DIFFUSE_TRANSMISSION
        if (has_role(map, DIFFUSE_TRANSMISSION_COLOR_ROLE)) {
            m.diffuse_transmission_color *= texel.rgb;
        }
#endif
#if THIN_SCATTER
        if (has_role(map, MULTISCATTER_COLOR_ROLE)) {
            m.multiscatter_color *= texel.rgb;
        }
#endif
#if SHEEN
        if (has_role(map, SHEEN_COLOR_ROLE)) {
            m.sheen_color *= texel.rgb;
        }
#endif
    } while (++color_map < color_end);
#endif
#if HAS_DATA_MAPS
    int data_map = int(maps.y & 0xffffffu);
    int data_end = data_map + int(maps.y >> 24);
    if (data_map < data_end) do {
        TextureMap map = texture_map(data_map, uv0, uv1);
        vec4 texel = sample_atlas(u_data_atlas, map);
        if (has_role(map, METALLIC_ROUGHNESS_ROLE)) {
            m.metallic *= texel.b;
            m.perceptual_roughness *= texel.g;
        }
        if (has_role(map, SPECULAR_ROLE)) {
            m.specular *= texel.a;
        }
#if HAS_TRANSMISSION
        if (has_role(map, TRANSMISSION_ROLE)) {
            m.transmission *= texel.r;
        }
#endif
#if DIFFUSE_TRANSMISSION
        if (has_role(map, DIFFUSE_TRANSMISSION_ROLE)) {
            m.diffuse_transmission *= texel.a;
        }
#endif
#if THIN_SCATTER
        if (has_role(map, SCATTER_STRENGTH_ROLE)) {
            m.scatter_strength *= texel.a;
        }
#endif
#if ANISOTROPIC
        if (has_role(map, ANISOTROPY_ROLE)) {
            m.anisotropy_strength *= texel.b;
            m.anisotropy_texel = texel.rg;
        }
#endif
#if DIFFUSE_ROUGH
        if (has_role(map, DIFFUSE_ROUGHNESS_ROLE)) {
            m.diffuse_roughness *= texel.r;
        }
#endif
#if SHEEN
        if (has_role(map, SHEEN_ROUGHNESS_ROLE)) {
            m.sheen_roughness *= texel.a;
        }
#endif
#if IRIDESCENT
        if (has_role(map, IRIDESCENCE_ROLE)) {
            m.iridescence *= texel.r;
        }
#endif
#if IRIDESCENT
        if (has_role(map, IRIDESCENCE_THICKNESS_ROLE)) {
            apply_iridescence_thickness(m, texel);
        }
#endif
#if CLEARCOAT
        if (has_role(map, CLEARCOAT_ROLE)) {
            m.clearcoat *= texel.r;
        }
#endif
#if CLEARCOAT
        if (has_role(map, CLEARCOAT_ROUGHNESS_ROLE)) {
            m.clearcoat_roughness *= texel.g;
        }
#endif
    } while (++data_map < data_end);
#endif
#if THIN_SCATTER
    apply_thin_scatter(m);
#endif
    return m;
}
