// Writes depth only. The holes of an alpha mask let light through, and so does the share 1 - alpha of the texels of a
// blended surface.
#if ALPHA_MODE
#include "material/uniforms.glsl"
#endif

#if ALPHA_MODE == 2
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
#if ALPHA_MODE == 1
    if (read_inputs().base_color.a < u_alpha_cutoff) discard;
#elif ALPHA_MODE == 2
    if (read_inputs().base_color.a < threshold()) discard;
#endif
}
