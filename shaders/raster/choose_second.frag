// The objects of the second surfaces, as depth.
#include "raster/planes.glsl"

uniform usampler2D u_chosen;

void main() {
    const uint all = (1u << SAMPLES) - 1u;
    uvec2 chosen = texelFetch(u_chosen, ivec2(gl_FragCoord.xy), 0).xy;
    uint triangle = chosen.y & 0xffffffu, first = chosen.x >> 24;
    gl_FragDepth = first == all || first == 0u ? NOTHING : FAR;
    for (bool is_hit = triangle != 0u; is_hit; is_hit = false) gl_FragDepth = object_depth(plane_of(triangle));
}
