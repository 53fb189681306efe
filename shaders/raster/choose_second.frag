// The objects of the second surfaces, as depth.
#include "raster/planes.glsl"
#include "raster/chosen.glsl"

uniform usampler2D u_chosen;

void main() {
    const uint all = (1u << SAMPLES) - 1u;
    uvec2 chosen = texelFetch(u_chosen, ivec2(gl_FragCoord.xy), 0).xy;
    uint number = chosen_numbers(chosen).y, first = chosen_samples(chosen).x;
    gl_FragDepth = number != 0u ? object_depth(number) : first == all || first == 0u ? NOTHING : FAR;
}
