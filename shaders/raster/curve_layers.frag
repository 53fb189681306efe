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
#endif
}
