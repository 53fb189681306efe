// The material at an interaction: factors, vertex colours and maps multiplied out as glTF 2.0 says.
#include "trace/interaction.glsl"
#if HAS_TEXTURES
#include "trace/atlas.glsl"
#endif

// What a map's record is read for (viewer/trace/scene/materials.py)
const uint BASE_COLOR_MAP = 1u, SPECULAR_COLOR_MAP = 2u, EMISSION_MAP = 4u;
const uint METALLIC_ROUGHNESS_MAP = 1u, SPECULAR_MAP = 2u, TRANSMISSION_MAP = 4u;

struct SurfaceMaterial {
    vec3 base_color;
    float coverage; // 0 or 1 of a mask, alpha of what blends, 1 of what is opaque
    float metallic, perceptual_roughness;
    vec3 emission;  // towards wo: the back has none unless the material is double sided
    float ior, specular;
    vec3 specular_color;
    float transmission;
    vec3 sigma;     // Beer's absorption by tracer units, beyond the surface
    bool is_thin, is_unlit, is_double_sided;
};

int material_word(int material, int part) {
    return u_materials + material * MATERIAL_WORDS + part;
}

float coverage_of(float alpha, int material, uint flags) {
#if HAS_SEE_THROUGH
    if ((flags & SEE_THROUGH) == 0u) return 1.0;
    float cutoff = word_float(material_word(material, 2)).w; // -1 where alpha blends
    return cutoff < 0.0 ? clamp(alpha, 0.0, 1.0) : float(alpha >= cutoff);
#else
    return 1.0;
#endif
}

SurfaceMaterial material_at(Interaction i) {
    SurfaceMaterial m;
    vec4 base = word_float(material_word(i.material, 0)) * i.color;
    vec4 factors = word_float(material_word(i.material, 1));
    m.metallic = factors.x;
    m.perceptual_roughness = factors.y;
    m.ior = factors.z;
    m.specular = factors.w;
    m.specular_color = vec3(1.0);
#if SPECULAR_TINTED
    m.specular_color = word_float(material_word(i.material, 2)).rgb;
#endif
    m.is_unlit = (i.flags & UNLIT) != 0u;
    m.is_thin = (i.flags & THIN) != 0u;
    m.is_double_sided = (i.flags & DOUBLE_SIDED) != 0u;
    m.emission = vec3(0.0);
#if HAS_EMISSION
    if (i.is_front || m.is_double_sided) m.emission = word_float(material_word(i.material, 3)).rgb;
#endif
    m.transmission = 0.0;
    m.sigma = vec3(0.0);
#if HAS_TRANSMISSION
    vec4 volume = word_float(material_word(i.material, 4));
    m.transmission = volume.w;
    m.sigma = volume.xyz;
#endif
#if HAS_TEXTURES
    uvec4 maps = word(material_word(i.material, 5));
#endif
#if HAS_COLOR_MAPS
    int color_end = int((maps.x & 0xffffffu) + (maps.x >> 24));
    for (int k = int(maps.x & 0xffffffu); k < color_end; ++k) {
        TextureMap map = texture_map(k, i.uv0, i.uv1);
        vec4 texel = sample_atlas(u_color_atlas, map);
        if (has_role(map, BASE_COLOR_MAP)) base *= texel;
        if (has_role(map, SPECULAR_COLOR_MAP)) m.specular_color *= texel.rgb;
        if (has_role(map, EMISSION_MAP)) m.emission *= texel.rgb;
    }
#endif
#if HAS_DATA_MAPS
    int data_end = int((maps.y & 0xffffffu) + (maps.y >> 24));
    for (int k = int(maps.y & 0xffffffu); k < data_end; ++k) {
        TextureMap map = texture_map(k, i.uv0, i.uv1);
        vec4 texel = sample_atlas(u_data_atlas, map);
        if (has_role(map, METALLIC_ROUGHNESS_MAP)) {
            m.metallic *= texel.b;
            m.perceptual_roughness *= texel.g;
        }
        if (has_role(map, SPECULAR_MAP)) m.specular *= texel.a;
        if (has_role(map, TRANSMISSION_MAP)) m.transmission *= texel.r;
    }
#endif
    m.base_color = base.rgb;
    m.coverage = coverage_of(base.a, i.material, i.flags);
    return m;
}

// A color map's first or last record, if it is read for `role`; else white
vec4 color_texel(Triangle tri, bool is_last, uint role) {
    vec4 texel = vec4(1.0);
#if HAS_COLOR_MAPS
    uint run = word(material_word(int(tri.material), 5)).x;
    int count = int(run >> 24);
    vec2 uv0 = vec2(interpolate(tri, 0).w, interpolate(tri, 1).w);
    vec2 uv1 = vec2(0.0);
#if HAS_UV1
    uv1 = interpolate(tri, 2 + HAS_TANGENT).xy;
#endif
    for (int k = 0; k < min(count, 1); ++k) {
        TextureMap map = texture_map(int(run & 0xffffffu) + (is_last ? count - 1 : 0), uv0, uv1);
        if (has_role(map, role)) texel = sample_atlas(u_color_atlas, map);
    }
#endif
    return texel;
}

// For shadow rays
float coverage_at(Hit hit) {
#if HAS_SEE_THROUGH
    Triangle tri = find_triangle(hit);
    float alpha = word_float(material_word(int(tri.material), 0)).a * color_texel(tri, false, BASE_COLOR_MAP).a;
#if HAS_COLOR
    alpha *= interpolate(tri, 2 + HAS_TANGENT + HAS_UV1).a;
#endif
    return coverage_of(alpha, int(tri.material), tri.flags);
#else
    return 1.0;
#endif
}

// For points chosen on emitters, on the side that shines
vec3 emission_at(Hit hit) {
#if HAS_EMISSION
    Triangle tri = find_triangle(hit);
    return word_float(material_word(int(tri.material), 3)).rgb * color_texel(tri, true, EMISSION_MAP).rgb;
#else
    return vec3(0.0);
#endif
}
