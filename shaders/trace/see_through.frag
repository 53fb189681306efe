// For each of a list of hits: 1 if the shadow ray passes the surface, else 0; with panes, the part of its light that
// does. The list has two texels for each hit: the texel of the hit texture, and the vector of the shadow ray.
#include "trace/see_through.glsl"
#if HAS_PANES
#include "trace/pane.glsl"
#endif

uniform usampler2D u_hits;

#if HAS_PANES
layout(location = 0) out vec4 o_passes;
#else
layout(location = 0) out float o_passes;
#endif

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy) * ivec2(2, 1);
    Hit hit = unpack_hit(texelFetch(u_hits, texel, 0));
    vec3 vector = uintBitsToFloat(texelFetch(u_hits, texel + ivec2(1, 0), 0).xyz);
    bool passes = shadow_ray_passes(hit, vector);
#if HAS_PANES
    vec3 wo = -normalize(vector);
    o_passes = vec4(passes ? vec3(1.0) : pane_transmittance(interact(hit, wo), wo), 1.0);
#else
    o_passes = passes ? 1.0 : 0.0;
#endif
}
