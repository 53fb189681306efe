// Writes the state of a path, for the passes that change it.
#include "trace/state.glsl"

layout(location = 0) out vec4 o_origin;
layout(location = 1) out vec4 o_direction;
layout(location = 2) out vec4 o_shadow_vector;
layout(location = 3) out vec4 o_throughput;
layout(location = 4) out vec4 o_radiance;
layout(location = 5) out vec4 o_shadow_origin; // of no effect where rays begin at one place
#if HAS_TRANSMISSION
layout(location = 6) out vec4 o_medium;
#endif

void write_path(Path p, float status) {
    bool has_shadow_ray = p.shadow_vector != vec3(0.0);
    vec3 pending = has_shadow_ray ? p.contribution : vec3(p.travelled, 0.0, 0.0);
#if HAS_SEE_THROUGH
    if (!has_shadow_ray) pending.y = p.kept;
#endif
    if (status == ENDED) o_origin = vec4(p.shadow_origin, status);
    else o_origin = vec4(p.origin, p.pdf > 0.0 ? clamp(p.pdf, 1e-37, NO_PDF) : NO_PDF);
    o_direction = vec4(p.direction, pending.r);
    o_shadow_vector = vec4(p.shadow_vector, pending.g);
    o_throughput = vec4(p.throughput, pending.b);
#if HAS_LIGHT_TREE
    o_shadow_origin = vec4(p.shadow_origin, p.facing);
#else
    o_shadow_origin = vec4(p.shadow_origin, 0.0);
#endif
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
