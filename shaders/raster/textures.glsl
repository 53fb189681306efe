// The maps a material may have. Map M is sampled where M_MAP is 1; it reads UV set M_UV, through u_M_transform where
// M_TRANSFORM is 1 (KHR_texture_transform as an affine map); M_MIRROR has bits for mirrored repetition along s and t.
#if UV_SETS & 1
in vec2 v_uv0;
#endif
#if UV_SETS & 2
in vec2 v_uv1;
#endif

vec2 mesh_uv(int uv_set) {
#if UV_SETS == 3
    return uv_set == 0 ? v_uv0 : v_uv1;
#elif UV_SETS == 2
    return v_uv1;
#elif UV_SETS == 1
    return v_uv0;
#else
    return vec2(0.0);
#endif
}

vec2 map_uv(int uv_set, int is_transformed, mat3x2 transform, int mirror) {
    vec2 uv = mesh_uv(uv_set);
    if (is_transformed != 0) uv = transform * vec3(uv, 1.0);
    vec2 folded = 1.0 - abs(mod(uv, 2.0) - 1.0);
    return vec2((mirror & 1) != 0 ? folded.x : uv.x, (mirror & 2) != 0 ? folded.y : uv.y);
}

#if BASE_COLOR_MAP
uniform sampler2D u_base_color_map;
uniform mat3x2 u_base_color_transform;
vec4 base_color_texel() {
    return texture(u_base_color_map, map_uv(BASE_COLOR_UV, BASE_COLOR_TRANSFORM,
        u_base_color_transform, BASE_COLOR_MIRROR));
}
#endif

#if METALLIC_ROUGHNESS_MAP
uniform sampler2D u_metallic_roughness_map;
uniform mat3x2 u_metallic_roughness_transform;
vec4 metallic_roughness_texel() {
    return texture(u_metallic_roughness_map, map_uv(METALLIC_ROUGHNESS_UV, METALLIC_ROUGHNESS_TRANSFORM,
        u_metallic_roughness_transform, METALLIC_ROUGHNESS_MIRROR));
}
#endif

#if NORMAL_MAP
uniform sampler2D u_normal_map;
uniform mat3x2 u_normal_transform;
vec4 normal_texel() {
    return texture(u_normal_map, map_uv(NORMAL_UV, NORMAL_TRANSFORM,
        u_normal_transform, NORMAL_MIRROR));
}
#endif

#if OCCLUSION_MAP
uniform sampler2D u_occlusion_map;
uniform mat3x2 u_occlusion_transform;
vec4 occlusion_texel() {
    return texture(u_occlusion_map, map_uv(OCCLUSION_UV, OCCLUSION_TRANSFORM,
        u_occlusion_transform, OCCLUSION_MIRROR));
}
#endif

#if EMISSIVE_MAP
uniform sampler2D u_emissive_map;
uniform mat3x2 u_emissive_transform;
vec4 emissive_texel() {
    return texture(u_emissive_map, map_uv(EMISSIVE_UV, EMISSIVE_TRANSFORM,
        u_emissive_transform, EMISSIVE_MIRROR));
}
#endif

#if SPECULAR_MAP
uniform sampler2D u_specular_map;
uniform mat3x2 u_specular_transform;
vec4 specular_texel() {
    return texture(u_specular_map, map_uv(SPECULAR_UV, SPECULAR_TRANSFORM,
        u_specular_transform, SPECULAR_MIRROR));
}
#endif

#if TRANSMISSION_MAP
uniform sampler2D u_transmission_map;
uniform mat3x2 u_transmission_transform;
vec4 transmission_texel() {
    return texture(u_transmission_map, map_uv(TRANSMISSION_UV, TRANSMISSION_TRANSFORM,
        u_transmission_transform, TRANSMISSION_MIRROR));
}
#endif

#if THICKNESS_MAP
uniform sampler2D u_thickness_map;
uniform mat3x2 u_thickness_transform;
vec4 thickness_texel() {
    return texture(u_thickness_map, map_uv(THICKNESS_UV, THICKNESS_TRANSFORM,
        u_thickness_transform, THICKNESS_MIRROR));
}
#endif

#if SPECULAR_COLOR_MAP
uniform sampler2D u_specular_color_map;
uniform mat3x2 u_specular_color_transform;
vec4 specular_color_texel() {
    return texture(u_specular_color_map, map_uv(SPECULAR_COLOR_UV, SPECULAR_COLOR_TRANSFORM,
        u_specular_color_transform, SPECULAR_COLOR_MIRROR));
}
#endif
