// Writes depth only; the holes of an alpha mask let light through.
#if ALPHA_MODE == 1
#include "material/uniforms.glsl"
#endif

void main() {
#if ALPHA_MODE == 1
    if (read_inputs().base_color.a < u_alpha_cutoff) discard;
#endif
}
