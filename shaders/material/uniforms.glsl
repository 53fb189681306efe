// Written by `python -m viewer.material` from viewer/scene/material.py; change it there.
// Reads a material for the raster, from uniforms and samplers (raster/attributes.glsl).
#include "material/inputs.glsl"
#include "raster/attributes.glsl"
#if SPECULAR_GLOSSINESS
#include "bsdf/specular_glossiness.glsl"
#endif
#if IRIDESCENT
#include "bsdf/iridescence_thickness.glsl"
#endif
#if THIN_SCATTER
#include "bsdf/thin_scatter.glsl"
#endif

uniform vec4 u_base_color;
#if ALPHA_MODE == 1
uniform float u_alpha_cutoff;
#endif
#if HAS_EMISSION
uniform vec3 u_emissive;
#endif
#if ANISOTROPIC
uniform float u_anisotropy_strength;
uniform float u_anisotropy_rotation;
#endif
#if CLEARCOAT
uniform float u_clearcoat;
uniform float u_clearcoat_roughness;
#endif
#if CLEARCOAT_NORMAL_MAP
uniform float u_clearcoat_normal_scale;
#endif
#if DIFFUSE_ROUGH
uniform float u_diffuse_roughness;
#endif
#if DIFFUSE_TRANSMISSION
uniform float u_diffuse_transmission;
uniform vec3 u_diffuse_transmission_color;
#endif
#if DISPERSIVE
uniform float u_dispersion;
#endif
#if HAS_NORMAL
uniform float u_metallic;
uniform float u_perceptual_roughness;
uniform float u_ior;
uniform float u_specular;
#endif
#if HAS_TRANSMISSION
uniform float u_transmission;
#endif
#if IRIDESCENT
uniform float u_iridescence;
uniform float u_iridescence_ior;
uniform float u_iridescence_thickness_minimum;
uniform float u_iridescence_thickness_maximum;
#endif
#if IS_SOLID
uniform float u_thickness;
#endif
#if NORMAL_MAP
uniform float u_normal_scale;
#endif
#if OCCLUSION_MAP
uniform float u_occlusion_strength;
#endif
#if SHEEN
uniform vec3 u_sheen_color;
uniform float u_sheen_roughness;
#endif
#if SPECULAR_TINTED
uniform vec3 u_specular_color;
#endif
#if THIN_SCATTER
uniform float u_scatter_strength;
uniform vec3 u_multiscatter_color;
uniform float u_multiscatter_anisotropy;
#endif

#if BASE_COLOR_MAP
uniform sampler2D u_base_color_map;
uniform mat3x2 u_base_color_transform;
vec4 base_color_texel() {
    return map_texel(u_base_color_map, BASE_COLOR_UV, BASE_COLOR_TRANSFORM,
        u_base_color_transform, BASE_COLOR_MIRROR);
}
#endif

#if METALLIC_ROUGHNESS_MAP
uniform sampler2D u_metallic_roughness_map;
uniform mat3x2 u_metallic_roughness_transform;
vec4 metallic_roughness_texel() {
    return map_texel(u_metallic_roughness_map, METALLIC_ROUGHNESS_UV, METALLIC_ROUGHNESS_TRANSFORM,
        u_metallic_roughness_transform, METALLIC_ROUGHNESS_MIRROR);
}
#endif

#if NORMAL_MAP
uniform sampler2D u_normal_map;
uniform mat3x2 u_normal_transform;
vec4 normal_texel() {
    return map_texel(u_normal_map, NORMAL_UV, NORMAL_TRANSFORM,
        u_normal_transform, NORMAL_MIRROR);
}
#endif

#if OCCLUSION_MAP
uniform sampler2D u_occlusion_map;
uniform mat3x2 u_occlusion_transform;
vec4 occlusion_texel() {
    return map_texel(u_occlusion_map, OCCLUSION_UV, OCCLUSION_TRANSFORM,
        u_occlusion_transform, OCCLUSION_MIRROR);
}
#endif

#if EMISSIVE_MAP
uniform sampler2D u_emissive_map;
uniform mat3x2 u_emissive_transform;
vec4 emissive_texel() {
    return map_texel(u_emissive_map, EMISSIVE_UV, EMISSIVE_TRANSFORM,
        u_emissive_transform, EMISSIVE_MIRROR);
}
#endif

#if SPECULAR_MAP
uniform sampler2D u_specular_map;
uniform mat3x2 u_specular_transform;
vec4 specular_texel() {
    return map_texel(u_specular_map, SPECULAR_UV, SPECULAR_TRANSFORM,
        u_specular_transform, SPECULAR_MIRROR);
}
#endif

#if SPECULAR_COLOR_MAP
uniform sampler2D u_specular_color_map;
uniform mat3x2 u_specular_color_transform;
vec4 specular_color_texel() {
    return map_texel(u_specular_color_map, SPECULAR_COLOR_UV, SPECULAR_COLOR_TRANSFORM,
        u_specular_color_transform, SPECULAR_COLOR_MIRROR);
}
#endif

#if SPECULAR_GLOSSINESS_MAP
uniform sampler2D u_specular_glossiness_map;
uniform mat3x2 u_specular_glossiness_transform;
vec4 specular_glossiness_texel() {
    return map_texel(u_specular_glossiness_map, SPECULAR_GLOSSINESS_UV, SPECULAR_GLOSSINESS_TRANSFORM,
        u_specular_glossiness_transform, SPECULAR_GLOSSINESS_MIRROR);
}
#endif

#if TRANSMISSION_MAP
uniform sampler2D u_transmission_map;
uniform mat3x2 u_transmission_transform;
vec4 transmission_texel() {
    return map_texel(u_transmission_map, TRANSMISSION_UV, TRANSMISSION_TRANSFORM,
        u_transmission_transform, TRANSMISSION_MIRROR);
}
#endif

#if THICKNESS_MAP
uniform sampler2D u_thickness_map;
uniform mat3x2 u_thickness_transform;
vec4 thickness_texel() {
    return map_texel(u_thickness_map, THICKNESS_UV, THICKNESS_TRANSFORM,
        u_thickness_transform, THICKNESS_MIRROR);
}
#endif

#if DIFFUSE_TRANSMISSION_MAP
uniform sampler2D u_diffuse_transmission_map;
uniform mat3x2 u_diffuse_transmission_transform;
vec4 diffuse_transmission_texel() {
    return map_texel(u_diffuse_transmission_map, DIFFUSE_TRANSMISSION_UV, DIFFUSE_TRANSMISSION_TRANSFORM,
        u_diffuse_transmission_transform, DIFFUSE_TRANSMISSION_MIRROR);
}
#endif

#if DIFFUSE_TRANSMISSION_COLOR_MAP
uniform sampler2D u_diffuse_transmission_color_map;
uniform mat3x2 u_diffuse_transmission_color_transform;
vec4 diffuse_transmission_color_texel() {
    return map_texel(u_diffuse_transmission_color_map, DIFFUSE_TRANSMISSION_COLOR_UV, DIFFUSE_TRANSMISSION_COLOR_TRANSFORM,
        u_diffuse_transmission_color_transform, DIFFUSE_TRANSMISSION_COLOR_MIRROR);
}
#endif

#if SCATTER_STRENGTH_MAP
uniform sampler2D u_scatter_strength_map;
uniform mat3x2 u_scatter_strength_transform;
vec4 scatter_strength_texel() {
    return map_texel(u_scatter_strength_map, SCATTER_STRENGTH_UV, SCATTER_STRENGTH_TRANSFORM,
        u_scatter_strength_transform, SCATTER_STRENGTH_MIRROR);
}
#endif

#if MULTISCATTER_COLOR_MAP
uniform sampler2D u_multiscatter_color_map;
uniform mat3x2 u_multiscatter_color_transform;
vec4 multiscatter_color_texel() {
    return map_texel(u_multiscatter_color_map, MULTISCATTER_COLOR_UV, MULTISCATTER_COLOR_TRANSFORM,
        u_multiscatter_color_transform, MULTISCATTER_COLOR_MIRROR);
}
#endif

#if ANISOTROPY_MAP
uniform sampler2D u_anisotropy_map;
uniform mat3x2 u_anisotropy_transform;
vec4 anisotropy_texel() {
    return map_texel(u_anisotropy_map, ANISOTROPY_UV, ANISOTROPY_TRANSFORM,
        u_anisotropy_transform, ANISOTROPY_MIRROR);
}
#endif

#if DIFFUSE_ROUGHNESS_MAP
uniform sampler2D u_diffuse_roughness_map;
uniform mat3x2 u_diffuse_roughness_transform;
vec4 diffuse_roughness_texel() {
    return map_texel(u_diffuse_roughness_map, DIFFUSE_ROUGHNESS_UV, DIFFUSE_ROUGHNESS_TRANSFORM,
        u_diffuse_roughness_transform, DIFFUSE_ROUGHNESS_MIRROR);
}
#endif

#if SHEEN_COLOR_MAP
uniform sampler2D u_sheen_color_map;
uniform mat3x2 u_sheen_color_transform;
vec4 sheen_color_texel() {
    return map_texel(u_sheen_color_map, SHEEN_COLOR_UV, SHEEN_COLOR_TRANSFORM,
        u_sheen_color_transform, SHEEN_COLOR_MIRROR);
}
#endif

#if SHEEN_ROUGHNESS_MAP
uniform sampler2D u_sheen_roughness_map;
uniform mat3x2 u_sheen_roughness_transform;
vec4 sheen_roughness_texel() {
    return map_texel(u_sheen_roughness_map, SHEEN_ROUGHNESS_UV, SHEEN_ROUGHNESS_TRANSFORM,
        u_sheen_roughness_transform, SHEEN_ROUGHNESS_MIRROR);
}
#endif

#if IRIDESCENCE_MAP
uniform sampler2D u_iridescence_map;
uniform mat3x2 u_iridescence_transform;
vec4 iridescence_texel() {
    return map_texel(u_iridescence_map, IRIDESCENCE_UV, IRIDESCENCE_TRANSFORM,
        u_iridescence_transform, IRIDESCENCE_MIRROR);
}
#endif

#if IRIDESCENCE_THICKNESS_MAP
uniform sampler2D u_iridescence_thickness_map;
uniform mat3x2 u_iridescence_thickness_transform;
vec4 iridescence_thickness_texel() {
    return map_texel(u_iridescence_thickness_map, IRIDESCENCE_THICKNESS_UV, IRIDESCENCE_THICKNESS_TRANSFORM,
        u_iridescence_thickness_transform, IRIDESCENCE_THICKNESS_MIRROR);
}
#endif

#if CLEARCOAT_MAP
uniform sampler2D u_clearcoat_map;
uniform mat3x2 u_clearcoat_transform;
vec4 clearcoat_texel() {
    return map_texel(u_clearcoat_map, CLEARCOAT_UV, CLEARCOAT_TRANSFORM,
        u_clearcoat_transform, CLEARCOAT_MIRROR);
}
#endif

#if CLEARCOAT_ROUGHNESS_MAP
uniform sampler2D u_clearcoat_roughness_map;
uniform mat3x2 u_clearcoat_roughness_transform;
vec4 clearcoat_roughness_texel() {
    return map_texel(u_clearcoat_roughness_map, CLEARCOAT_ROUGHNESS_UV, CLEARCOAT_ROUGHNESS_TRANSFORM,
        u_clearcoat_roughness_transform, CLEARCOAT_ROUGHNESS_MIRROR);
}
#endif

#if CLEARCOAT_NORMAL_MAP
uniform sampler2D u_clearcoat_normal_map;
uniform mat3x2 u_clearcoat_normal_transform;
vec4 clearcoat_normal_texel() {
    return map_texel(u_clearcoat_normal_map, CLEARCOAT_NORMAL_UV, CLEARCOAT_NORMAL_TRANSFORM,
        u_clearcoat_normal_transform, CLEARCOAT_NORMAL_MIRROR);
}
#endif

MaterialInputs read_inputs() {
    MaterialInputs m = DEFAULT_INPUTS;
    m.base_color = u_base_color;
#if HAS_EMISSION
    m.emissive = u_emissive;
#endif
#if ANISOTROPIC
    m.anisotropy_strength = u_anisotropy_strength;
    m.anisotropy_rotation = u_anisotropy_rotation;
#endif
#if CLEARCOAT
    m.clearcoat = u_clearcoat;
    m.clearcoat_roughness = u_clearcoat_roughness;
#endif
#if DIFFUSE_ROUGH
    m.diffuse_roughness = u_diffuse_roughness;
#endif
#if DIFFUSE_TRANSMISSION
    m.diffuse_transmission = u_diffuse_transmission;
    m.diffuse_transmission_color = u_diffuse_transmission_color;
#endif
#if DISPERSIVE
    m.dispersion = u_dispersion;
#endif
#if HAS_NORMAL
    m.metallic = u_metallic;
    m.perceptual_roughness = u_perceptual_roughness;
    m.ior = u_ior;
    m.specular = u_specular;
#endif
#if HAS_TRANSMISSION
    m.transmission = u_transmission;
#endif
#if IRIDESCENT
    m.iridescence = u_iridescence;
    m.iridescence_ior = u_iridescence_ior;
    m.iridescence_thickness_minimum = u_iridescence_thickness_minimum;
    m.iridescence_thickness_maximum = u_iridescence_thickness_maximum;
#endif
#if IS_SOLID
    m.thickness = u_thickness;
#endif
#if SHEEN
    m.sheen_color = u_sheen_color;
    m.sheen_roughness = u_sheen_roughness;
#endif
#if SPECULAR_TINTED
    m.specular_color = u_specular_color;
#endif
#if THIN_SCATTER
    m.scatter_strength = u_scatter_strength;
    m.multiscatter_color = u_multiscatter_color;
    m.multiscatter_anisotropy = u_multiscatter_anisotropy;
#endif
#if BASE_COLOR_MAP
    {
        vec4 texel = base_color_texel();
        m.base_color *= texel.rgba;
    }
#endif
#if METALLIC_ROUGHNESS_MAP
    {
        vec4 texel = metallic_roughness_texel();
        m.metallic *= texel.b;
        m.perceptual_roughness *= texel.g;
    }
#endif
#if EMISSIVE_MAP
    {
        vec4 texel = emissive_texel();
        m.emissive *= texel.rgb;
    }
#endif
#if SPECULAR_MAP
    {
        vec4 texel = specular_texel();
        m.specular *= texel.a;
    }
#endif
#if SPECULAR_COLOR_MAP
    {
        vec4 texel = specular_color_texel();
        m.specular_color *= texel.rgb;
    }
#endif
#if SPECULAR_GLOSSINESS_MAP && SPECULAR_GLOSSINESS
    {
        vec4 texel = specular_glossiness_texel();
        apply_specular_glossiness(m, texel);
    }
#endif
#if TRANSMISSION_MAP
    {
        vec4 texel = transmission_texel();
        m.transmission *= texel.r;
    }
#endif
#if THICKNESS_MAP
    {
        vec4 texel = thickness_texel();
        m.thickness *= texel.g;
    }
#endif
#if DIFFUSE_TRANSMISSION_MAP
    {
        vec4 texel = diffuse_transmission_texel();
        m.diffuse_transmission *= texel.a;
    }
#endif
#if DIFFUSE_TRANSMISSION_COLOR_MAP
    {
        vec4 texel = diffuse_transmission_color_texel();
        m.diffuse_transmission_color *= texel.rgb;
    }
#endif
#if SCATTER_STRENGTH_MAP
    {
        vec4 texel = scatter_strength_texel();
        m.scatter_strength *= texel.a;
    }
#endif
#if MULTISCATTER_COLOR_MAP
    {
        vec4 texel = multiscatter_color_texel();
        m.multiscatter_color *= texel.rgb;
    }
#endif
#if ANISOTROPY_MAP
    {
        vec4 texel = anisotropy_texel();
        m.anisotropy_strength *= texel.b;
        m.anisotropy_texel = texel.rg;
    }
#endif
#if DIFFUSE_ROUGHNESS_MAP
    {
        vec4 texel = diffuse_roughness_texel();
        m.diffuse_roughness *= texel.r;
    }
#endif
#if SHEEN_COLOR_MAP
    {
        vec4 texel = sheen_color_texel();
        m.sheen_color *= texel.rgb;
    }
#endif
#if SHEEN_ROUGHNESS_MAP
    {
        vec4 texel = sheen_roughness_texel();
        m.sheen_roughness *= texel.a;
    }
#endif
#if IRIDESCENCE_MAP
    {
        vec4 texel = iridescence_texel();
        m.iridescence *= texel.r;
    }
#endif
#if IRIDESCENCE_THICKNESS_MAP && IRIDESCENT
    {
        vec4 texel = iridescence_thickness_texel();
        apply_iridescence_thickness(m, texel);
    }
#endif
#if CLEARCOAT_MAP
    {
        vec4 texel = clearcoat_texel();
        m.clearcoat *= texel.r;
    }
#endif
#if CLEARCOAT_ROUGHNESS_MAP
    {
        vec4 texel = clearcoat_roughness_texel();
        m.clearcoat_roughness *= texel.g;
    }
#endif
#if HAS_COLOR
    m.base_color *= v_color;
#endif
#if THIN_SCATTER
    apply_thin_scatter(m);
#endif
    return m;
}
