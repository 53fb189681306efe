// The material at an interaction: the product of factors, vertex colours and maps, as glTF 2.0 defines it.
#include "trace/interaction.glsl"

struct SurfaceMaterial {
    MaterialInputs inputs;
    float coverage; // 0 or 1 for alpha mode mask, alpha for blend, 1 for opaque
    vec3 emission;  // towards wo; the back emits only if the material is double sided
    bool is_thin, is_unlit, is_double_sided;
    bool is_pane;   // light goes straight on through it where it is smooth (trace/pane.glsl)
};

float coverage_of(float alpha, int material, int flags) {
#if HAS_SEE_THROUGH
    if ((flags & FLAG_SEE_THROUGH) == 0) return 1.0;
    float cutoff = alpha_cutoff_factor(material); // -1 for alpha mode blend
    return cutoff < 0.0 ? clamp(alpha, 0.0, 1.0) : float(alpha >= cutoff);
#else
    return 1.0;
#endif
}

SurfaceMaterial material_at(Interaction i) {
    SurfaceMaterial m;
    m.inputs = read_inputs(i.material, i.color, i.uv0, i.uv1);
    m.is_unlit = (i.flags & FLAG_UNLIT) != 0;
    m.is_thin = (i.flags & FLAG_THIN) != 0;
    m.is_double_sided = (i.flags & FLAG_DOUBLE_SIDED) != 0;
    m.is_pane = (i.flags & FLAG_PANE) != 0;
    m.emission = i.is_front || m.is_double_sided ? m.inputs.emissive : vec3(0.0);
    m.coverage = coverage_of(m.inputs.base_color.a, i.material, i.flags);
    return m;
}

// The texel of the material's first or last colour map if that serves `role`, else white
vec4 color_texel(Triangle tri, bool is_last, uint role) {
    vec4 texel = vec4(1.0);
#if HAS_COLOR_MAPS
    uint run = map_records(tri.material).x;
    int count = int(run >> 24);
    vec2 uv0 = vec2(interpolate(tri, 0).w, interpolate(tri, 1).w);
    vec2 uv1 = vec2(0.0);
#if HAS_UV1
    uv1 = interpolate(tri, VERTEX_UV1).xy;
#endif
    if (count > 0) {
        TextureMap map = texture_map(int(run & 0xffffffu) + (is_last ? count - 1 : 0), uv0, uv1);
        if (has_role(map, role)) texel = sample_atlas(u_color_atlas, map);
    }
#endif
    return texel;
}

// The coverage at a hit of a shadow ray
float coverage_at(Hit hit) {
#if HAS_SEE_THROUGH
    Triangle tri = find_triangle(hit);
    float alpha = base_color_factor(tri.material).a * color_texel(tri, false, BASE_COLOR_ROLE).a;
#if HAS_COLOR
    alpha *= interpolate(tri, VERTEX_COLOR).a;
#endif
    return coverage_of(alpha, tri.material, tri.flags);
#else
    return 1.0;
#endif
}

// The emission at a sampled point of an emitter, on the emitting side
vec3 emission_at(Hit hit) {
#if HAS_EMISSION
    Triangle tri = find_triangle(hit);
    return emissive_factor(tri.material) * color_texel(tri, true, EMISSIVE_ROLE).rgb;
#else
    return vec3(0.0);
#endif
}
