// A view of one quantity of curves, in place of their shading. Their base colour is that of many such fibres together.
#include "raster/curve_shade.glsl"
#include "raster/view_value.glsl"

uniform vec3 u_fibre; // as in curve_phong.frag

void main() {
    CurvePoint at;
    if (!curve_point(at)) discard;
    CurveFrame c = curve_frame(at);
#if SHOW == 0
    vec3 color = exp(-u_fibre.x * sqrt(absorption()));
#elif SHOW == 1 || SHOW == 2
    vec3 n = at.across * c.axes[1] + sqrt(max(1.0 - at.across * at.across, 0.0)) * c.axes[2]; // of a round tube
    vec3 color = linear_from_code(code_of_normal(n));
#elif SHOW == 6
    vec3 color = linear_from_code(code_of_depth(at.position));
#elif SHOW == 7
    vec3 color = vec3(1.0);
#else
    vec3 color = linear_from_code(HAS_NONE);
#endif
    write_curve(color, at);
}
