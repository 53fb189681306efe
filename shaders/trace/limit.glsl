// CLAMP = 1: no contribution of indirect light is brighter than u_clamp. Fewer fireflies, and a picture too dark.
#if CLAMP
#include "sample/luminance.glsl"

uniform float u_clamp;
#endif

// `scattered`: how often the light that is met was scattered; once is direct.
vec3 limited(vec3 contribution, int scattered) {
#if CLAMP
    if (scattered > 1) contribution *= min(1.0, u_clamp / max(luminance(contribution), 1e-30));
#endif
    return contribution;
}
