// Nothing to write but depth; a mask's holes let light through.
#if ALPHA_MODE == 1
#include "raster/textures.glsl"
uniform vec4 u_base_color;
uniform float u_alpha_cutoff;
#if HAS_COLOR
in vec4 v_color;
#endif
#endif

void main() {
#if ALPHA_MODE == 1
    float alpha = u_base_color.a;
#if BASE_COLOR_MAP
    alpha *= base_color_texel().a;
#endif
#if HAS_COLOR
    alpha *= v_color.a;
#endif
    if (alpha < u_alpha_cutoff) discard;
#endif
}
