// Counts of fragments, as the colours that viewer/plan/legend.py has for them.
#include "raster/view_value.glsl"
uniform sampler2D u_counts;
uniform vec3 u_colors[COLORS]; // codes; the last one is for all greater counts
out vec4 o_color;

void main() {
    int count = int(texelFetch(u_counts, ivec2(gl_FragCoord.xy), 0).r + 0.5);
    o_color = count == 0 ? vec4(0.0) : vec4(linear_from_code(u_colors[min(count, COLORS) - 1]), 1.0);
}
