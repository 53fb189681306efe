// Writes depth only. The holes of an alpha mask let light through, and so does the share 1 - alpha of the texels of a
// blended surface, and what a pane transmits (PANE) by its luminance, since a depth has no colour.
#if ALPHA_MODE || PANE
#include "material/uniforms.glsl"
#if ALPHA_MODE == 1
#include "raster/alpha_mask.glsl"
#endif
#endif

#if PANE
#include "bsdf/bsdf.glsl"
#include "raster/straight_through.glsl"
#include "sample/luminance.glsl"
in vec3 v_position;
uniform vec4 u_light; // where it is, in scene units; w = 0: its direction; all 0: panes stop it

// As pane_transmittance in trace/pane.glsl, for a wall without a film whose specular has no colour; flat, as its
// triangles are
float passed(MaterialInputs m) {
    float alpha = m.perceptual_roughness * m.perceptual_roughness;
    if (is_delta(vec2(alpha)) && u_light != vec4(0.0)) {
        vec3 n = cross(dFdx(v_position), dFdy(v_position)), l = u_light.xyz - u_light.w * v_position;
        float mu = abs(dot(n, l)) / max(length(n) * length(l), 1e-30);
        return straight_through(m, min(mu, 1.0)) * luminance(m.base_color.rgb);
    }
    return 0.0;
}
#endif

#if ALPHA_MODE == 2 || PANE
uniform uint u_caster; // number of the instance (viewer/raster/surfaces.py)

// 16 thresholds in (0, 1), which repeat every four texels, so that the filter of light/shadow.glsl leaves no pattern.
// Their order depends on the instance and on the side that faces the light: what several surfaces let through is about
// the product of their shares.
float threshold() {
    uint key = 2u * u_caster + (gl_FrontFacing ? 0u : 1u);
    uvec2 p = uvec2(gl_FragCoord.xy) & 3u;
    uint order = (p.x | p.y << 2) ^ (key & 15u);
    order = order * (2u * key + 5u) & 15u; // an odd factor permutes the numbers below 16
    order ^= order >> 2;
    order = order * (key | 1u) & 15u;
    return (float(order) + 0.5) / 16.0;
}
#endif

void main() {
#if ALPHA_MODE || PANE
    MaterialInputs m = read_inputs();
    float covered = 1.0;
#if ALPHA_MODE == 1
    if (mask_coverage(m.base_color.a) < 1.0) discard;
#elif ALPHA_MODE == 2
    covered = m.base_color.a;
#endif
#if PANE
    covered *= 1.0 - passed(m);
#endif
#if ALPHA_MODE == 2 || PANE
    if (covered < threshold()) discard;
#endif
#endif
}
