// The phase function of a medium, by its number: g of that of Henyey & Greenstein, or above 1, with HAS_DROPLETS, the
// diameter of droplets in micrometres. Directions are those of travel, before and after.
#if HAS_DROPLETS
#include "media/droplets.glsl"
#else
#include "media/phase.glsl"
#endif

float any_phase(float phase, vec3 before, vec3 after) {
#if HAS_DROPLETS
    if (phase > 1.0) return droplets_between(droplets(phase), before, after);
#endif
    return phase_between(phase, before, after);
}

// u in [0, 1)^2
vec3 any_phase_sample(float phase, vec3 direction, vec2 u) {
#if HAS_DROPLETS
    if (phase > 1.0) return droplets_sample(droplets(phase), direction, u);
#endif
    return phase_sample(phase, direction, u);
}
