// What the surface is that a pixel shows at its centre, as numbers (docs/layers.md). OUT_NORMAL, OUT_IDS, OUT_ALBEDO
// and OUT_UV are the places of the outputs that are wanted; 0: not wanted.
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
uniform mat3 u_pixel_ray, u_pixel_origin; // (x, y, 1), in pixels, to a ray's direction and start

// Where the ray through the pixel's centre meets the plane of the triangle. GPUs round the corners of a triangle to
// 1/256 of a pixel, and interpolate between these: what they give is in the plane, and a little beside the ray.
vec3 at_center(vec3 p, vec3 normal) {
    vec3 pixel = vec3(gl_FragCoord.xy, 1.0), o = u_pixel_origin * pixel, d = u_pixel_ray * pixel;
    float across = dot(normal, d);
    return across == 0.0 ? p : o + d * (dot(normal, p - o) / across);
}

// What is interpolated changes over the plane in proportion to the way in it, which is x of the step dx to the next
// pixel and y of the step dy.
vec2 steps_to(vec3 way, vec3 dx, vec3 dy) {
    vec3 normal = cross(dx, dy);
    vec2 steps = vec2(dot(cross(way, dy), normal), dot(cross(dx, way), normal)) / max(dot(normal, normal), 1e-37);
    return clamp(steps, -1.0, 1.0);
}
#define AT_CENTER(value) ((value) + off.x * dFdx(value) + off.y * dFdy(value))

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
    Surface s = surface_of(m);
    vec3 emission = m.emissive;
#if CLEARCOAT
    emission *= make_coat(s.coat, s.coat_alpha, n_coat, clamp(dot(n_coat, v), 1e-4, 1.0), u_dfg).throughput;
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
    vec3 dx = dFdx(v_position), dy = dFdy(v_position), face = cross(dx, dy); // 0 on lines and points
    face *= sign(dot(face, v)) / max(length(face), 1e-30);
    vec2 off = face == vec3(0.0) ? vec2(0.0) : steps_to(at_center(v_position, face) - v_position, dx, dy);
#if HAS_NORMAL
    vec3 front = geometric_normal(), own = shading_normal(front);
    vec3 n = bend_normal(normalize(AT_CENTER(own)), face == vec3(0.0) ? front : face, v);
#if CLEARCOAT
    vec3 n_coat = coat_normal(front);
#else
    vec3 n_coat = n;
#endif
#else
    vec3 n = face, n_coat = face;
#endif
    o_color = vec4(AT_CENTER(v_position), 1.0); // w = 0 marks an empty pixel
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
    o_uv = vec4(AT_CENTER(mesh_uv(UV_SET)), 0.0, 0.0);
#else
    o_uv = vec4(0.0);
#endif
#if HAS_MOTION
    o_uv.zw = motion(AT_CENTER(v_clip), AT_CENTER(v_next_clip));
#endif
#endif
#if ALPHA_MODE == 2
    if (covered < 0.5) discard;
#endif
    drop_uncovered(covered);
}
