// Media by their numbers, which paths carry: what light meets between surfaces. Number 0 is the vacuum.
// A medium is a record of the scene buffer's section `media` (viewer/trace/scene/encode.py):
//   rgb: sigma_a, absorption by tracer unit
// HAS_VOLUME: there are others than the vacuum.
#if HAS_VOLUME
#include "trace/words.glsl"

uniform int u_media;
#endif

// Transmittance over a distance in a medium: exp(-sigma_a d)       Beer 1852
vec3 transmittance(int medium, float distance) {
#if HAS_VOLUME
    return exp(-word_float(u_media + medium).rgb * distance);
#else
    return vec3(1.0);
#endif
}
