// What the curve is that a pixel shows at its centre, as numbers (layers.frag).
#include "raster/curve_frame.glsl"
#include "raster/layer_outputs.glsl"
#if OUT_ALBEDO
#include "bsdf/fibre/fibre.glsl"
uniform vec4 u_fibre; // beta_m, beta_n, tilt, index of refraction
#if HAS_COLORS
in vec3 v_sigma_a;
#else
uniform vec3 u_sigma_a;
#endif
#endif
layout(location = 0) out vec4 o_color;

#if HAS_MOTION
uniform mat4 u_view_projection, u_next_view_projection;
uniform mat4 u_to_next;         // from this eye-relative space to that of the next time
#if !YARN
#if ROUND != 2
uniform mat4 u_to_eye;          // from the space of the points
#endif
uniform mat4 u_next_to_eye;     // of the points at the next time
uniform sampler2D u_points, u_next_points;

vec3 point_in(sampler2D points, mat4 to_eye, int k) {
    return (to_eye * vec4(texelFetch(points, ivec2(k & (POINTS_WIDTH - 1), k / POINTS_WIDTH), 0).xyz, 1.0)).xyz;
}
#endif

// Where p is at the next time: as far along its segment, and as far off its axis. The points of yarns are taken to
// stand.
vec3 next_position(vec3 p) {
    vec3 next = (u_to_next * vec4(p, 1.0)).xyz;
#if !YARN
    int k = int(v_number);
    vec3 a = point_in(u_points, u_to_eye, k), b = point_in(u_points, u_to_eye, k + 1);
    float share = clamp(dot(p - a, b - a) / max(dot(b - a, b - a), 1e-30), 0.0, 1.0);
    vec3 axis = (u_to_next * vec4(mix(a, b, share), 1.0)).xyz;
    next += mix(point_in(u_next_points, u_next_to_eye, k), point_in(u_next_points, u_next_to_eye, k + 1), share) - axis;
#endif
    return next;
}
#endif

void main() {
    CurvePoint at;
    if (!curve_point(at)) discard;
#if ROUND != 2
    if (!is_covered()) discard;
#endif
    CurveFrame c = curve_frame(at);
    vec3 n = c.axes * vec3(0.0, at.across, sqrt(max(1.0 - at.across * at.across, 0.0)));
    o_color = vec4(at.position, 1.0);
#if OUT_NORMAL
    o_normal = vec4(n, 0.0);
#endif
#if OUT_IDS
    o_ids = u_ids;
#endif
#if OUT_ALBEDO
#if HAS_COLORS
    vec3 sigma_a = v_sigma_a;
#else
    vec3 sigma_a = u_sigma_a;
#endif
#if IS_ORTHOGRAPHIC
    vec3 v = u_view_direction;
#else
    vec3 v = -normalize(at.position);
#endif
    vec3 wo = v * mat3(c.axes[0], cross(n, c.axes[0]), n);
    Fibre f = Fibre(sigma_a, u_fibre.x, u_fibre.y, u_fibre.z, u_fibre.w);
    o_albedo = vec4(min(fibre_albedo(f, fibre_offset(vec3(0.0, 0.0, 1.0), wo), wo), 1.0), 0.0);
#endif
#if OUT_UV
    o_uv = vec4(0.0);
#if HAS_MOTION
    vec3 next = next_position(at.position);
    o_uv.zw = motion(u_view_projection * vec4(at.position, 1.0), u_next_view_projection * vec4(next, 1.0));
#endif
#endif
}
