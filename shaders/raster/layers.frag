// What the surface is that a pixel shows at its centre, as numbers (docs/layers.md). OUT_NORMAL, OUT_IDS, OUT_ALBEDO and
// OUT_UV are the places of the outputs that are wanted; 0: not wanted.
#include "raster/material.glsl"
#if OUT_ALBEDO && IS_LIT
#include "bsdf/surface_of.glsl"
uniform sampler2D u_dfg;
#endif
#if HAS_NORMAL
#include "raster/normal.glsl"
#endif
#include "trace/shading_normal.glsl"
#include "raster/layer_outputs.glsl"
#if IS_ORTHOGRAPHIC
uniform vec3 u_view_direction; // towards the eye
#endif

#if INSTANCED && OUT_IDS
flat in vec2 v_instance;
#endif
#if HAS_MOTION
in vec4 v_clip, v_next_clip; // clip space at this time and at the next
#endif

#if OUT_ALBEDO
// As layers.frag of the path tracer has it: light that is emitted counts, too, and glass is white.
vec3 seen_albedo(MaterialInputs m, vec3 n, vec3 n_coat, vec3 v) {
#if !IS_LIT
    return m.base_color.rgb + m.emissive;
#elif HAS_TRANSMISSION
    return vec3(1.0);
#else
#if !REFLECTS
    m.specular = 0.0;
#endif
    m.perceptual_roughness = clamp(m.perceptual_roughness, MIN_PERCEPTUAL_ROUGHNESS, 1.0);
    Surface s = surface_of(m);
    vec3 emission = m.emissive;
#if CLEARCOAT
    float alpha = max(s.coat_alpha, MIN_PERCEPTUAL_ROUGHNESS * MIN_PERCEPTUAL_ROUGHNESS);
    emission *= make_coat(s.coat, alpha, n_coat, clamp(dot(n_coat, v), 1e-4, 1.0), u_dfg).throughput;
#endif
    return surface_albedo(s, clamp(dot(n, v), 1e-4, 1.0), u_dfg) + emission;
#endif
}
#endif

void main() {
    MaterialInputs m = read_inputs();
    float covered = coverage(m.base_color.a);
#if IS_ORTHOGRAPHIC
    vec3 v = u_view_direction;
#else
    vec3 v = -normalize(v_position);
#endif
    vec3 face = cross(dFdx(v_position), dFdy(v_position)); // 0 on lines and points
    face *= sign(dot(face, v)) / max(length(face), 1e-30);
#if HAS_NORMAL
    vec3 front = geometric_normal(), n = bend_normal(shading_normal(front), face == vec3(0.0) ? front : face, v);
#if CLEARCOAT
    vec3 n_coat = coat_normal(front);
#else
    vec3 n_coat = n;
#endif
#else
    vec3 n = face, n_coat = face;
#endif
    o_color = vec4(v_position, 1.0); // w = 0 marks an empty pixel
#if OUT_NORMAL
    o_normal = vec4(n, 0.0);
#endif
#if OUT_IDS
#if INSTANCED
    o_ids = vec4(v_instance, u_ids.zw);
#else
    o_ids = u_ids;
#endif
#endif
#if OUT_ALBEDO
    o_albedo = vec4(min(seen_albedo(m, n, n_coat, v), 1.0), 0.0);
#endif
#if OUT_UV
#if UV_SET >= 0
    o_uv = vec4(mesh_uv(UV_SET), 0.0, 0.0);
#else
    o_uv = vec4(0.0);
#endif
#if HAS_MOTION
    o_uv.zw = motion(v_clip, v_next_clip);
#endif
#endif
#if ALPHA_MODE == 2
    if (covered < 0.5) discard;
#endif
    drop_uncovered(covered);
}
