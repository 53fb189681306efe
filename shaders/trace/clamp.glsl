// With CLAMP = 1 the luminance of every contribution of indirect light is limited to u_clamp. The picture has fewer
// fireflies and is too dark.
#if CLAMP
#include "sample/luminance.glsl"

uniform float u_clamp;
#endif

// `scattered`: the number of scattering events between the light and the camera; 1 is direct light.
vec3 clamped(vec3 contribution, int scattered) {
#if CLAMP
    if (scattered > 1) contribution *= min(1.0, u_clamp / max(luminance(contribution), 1e-30));
#endif
    return contribution;
}
