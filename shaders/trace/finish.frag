// Adds the radiance of the paths that have ended to the sums of the wavefront.
#include "trace/state.glsl"
#include "trace/clamp.glsl"
#include "trace/mis.glsl"
#include "trace/environment.glsl"
#include "trace/background.glsl"
#include "trace/flight.glsl"
#include "trace/is_finite.glsl"

layout(location = 0) out vec4 o_sum;     // rgb, 1
layout(location = 1) out vec4 o_squares; // of rgb; alpha

void main() {
    ivec2 texel = source_of(ivec2(gl_FragCoord.xy));
    bool is_in_flight = sign(texelFetch(u_origin, texel, 0).w) == IN_FLIGHT;
    Path p = read_path(texel, texelFetch(u_hit, texel, 0));
    bool is_empty = is_in_flight && p.depth == int(RAYS == 1); // the camera ray hits nothing
    float alpha = is_empty && BACKGROUND == 0 ? 0.0 : 1.0;
#if HAS_ENVIRONMENT
    if (is_in_flight && (BACKGROUND > 0 || !is_empty)) {
        float weight = p.pdf > 0.0 ? bsdf_weight(p.pdf, environment_pdf(p.direction)) : 1.0;
        vec3 radiance = is_empty ? background_radiance(p.direction) : environment_radiance(p.direction);
#if HAS_SCATTERING
        pass_medium(p, leaves_media(p.origin, p.direction));
#else
        pass_medium(p, FAR); // as for light samples of the environment
#endif
        p.radiance += clamped(p.throughput * radiance * weight, p.depth);
    }
#endif
    // A sample that is not finite is left out of the sums and of the count, so that the missing count shows it.
    bool is_good = is_finite(p.radiance);
    o_sum = is_good ? vec4(p.radiance, 1.0) : vec4(0.0);
    o_squares = is_good ? vec4(p.radiance * p.radiance, alpha) : vec4(0.0);
}
