// For each of a list of hits: 1 if the shadow ray passes the surface, else 0. The list has two texels for each hit: the
// texel of the hit texture, and the vector of the shadow ray.
#include "trace/see_through.glsl"

uniform usampler2D u_hits;

layout(location = 0) out float o_passes;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy) * ivec2(2, 1);
    uvec4 hit = texelFetch(u_hits, texel, 0);
    vec3 vector = uintBitsToFloat(texelFetch(u_hits, texel + ivec2(1, 0), 0).xyz);
    o_passes = shadow_ray_passes(unpack_hit(hit), vector) ? 1.0 : 0.0;
}
