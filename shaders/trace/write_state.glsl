// Writes the state of a path, for the passes that change it.
#include "trace/state.glsl"

layout(location = 0) out vec4 o_origin;
layout(location = 1) out vec4 o_direction;
layout(location = 2) out vec4 o_shadow_origin;
layout(location = 3) out vec4 o_shadow_vector;
layout(location = 4) out vec4 o_throughput;
layout(location = 5) out vec4 o_radiance;
#if HAS_TRANSMISSION
layout(location = 6) out vec4 o_medium;
#endif

void write_path(Path p, float status) {
    bool has_shadow_ray = p.shadow_vector != vec3(0.0);
    o_origin = vec4(p.origin, status);
#if HAS_LIGHT_TREE
    if (status == IN_FLIGHT) o_origin.w += p.facing;
#endif
    o_direction = vec4(p.direction, p.pdf);
#if HAS_SEE_THROUGH
    vec3 in_place = vec3(p.travelled, p.kept, 0.0);
#else
    vec3 in_place = vec3(p.travelled, 0.0, 0.0);
#endif
    o_shadow_origin = vec4(has_shadow_ray ? p.shadow_origin : in_place, p.contribution.r);
    o_shadow_vector = vec4(p.shadow_vector, p.contribution.g);
    o_throughput = vec4(p.throughput, p.contribution.b);
    o_radiance = vec4(p.radiance, pack_counters(p.depth, p.steps, p.left));
#if HAS_TRANSMISSION
    o_medium = vec4(p.medium, 0.0, 0.0, p.eta2);
#if HAS_PANES
    o_medium.y = p.travelled;
#endif
#endif
#if HAS_SCATTERING
    o_medium.y = p.is_lit ? p.travelled : float(p.shadow_medium);
#if HAS_PANES
    if (!p.is_lit && has_shadow_ray && p.travelled > 0.0) o_medium.y = -p.travelled;
#endif
    o_medium.w = p.is_lit ? -p.eta2 : p.eta2;
#endif
#if DISPERSIVE
    o_medium.z = p.wavelength;
#endif
}

void write_idle() {
    o_origin = o_direction = o_shadow_origin = o_shadow_vector = o_throughput = o_radiance = vec4(0.0);
#if HAS_TRANSMISSION
    o_medium = vec4(0.0);
#endif
}
