// Slots whose path ended: its radiance, added to the wave's sums.
#include "trace/state.glsl"
#include "trace/limit.glsl"
#include "trace/mis.glsl"
#include "trace/environment.glsl"
#include "trace/is_finite.glsl"

layout(location = 0) out vec4 o_sum;     // rgb, 1
layout(location = 1) out vec4 o_squares; // of rgb; alpha

void main() {
    ivec2 slot = ivec2(gl_FragCoord.xy);
    bool is_in_flight = texelFetch(u_origin, slot, 0).w == IN_FLIGHT;
    Path p = read_path(slot, texelFetch(u_hit, slot, 0));
    bool is_empty = is_in_flight && p.depth == int(RAYS == 1); // the first ray meets nothing
    float alpha = is_empty ? float(BACKGROUND) : 1.0;
#if HAS_ENVIRONMENT
    if (is_in_flight && (BACKGROUND == 1 || !is_empty)) {
        float weight = p.pdf > 0.0 ? bsdf_weight(p.pdf, environment_pdf(p.direction)) : 1.0;
        p.radiance += limited(p.throughput * environment_radiance(p.direction) * weight, p.depth);
    }
#endif
    // One that is not finite is left out of sums and counts: the count that is missing tells of it.
    bool is_good = is_finite(p.radiance);
    o_sum = is_good ? vec4(p.radiance, 1.0) : vec4(0.0);
    o_squares = is_good ? vec4(p.radiance * p.radiance, alpha) : vec4(0.0);
}
