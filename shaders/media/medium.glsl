// Media between surfaces. A path carries the number of the medium that it travels in; number 0 is the vacuum.
// Each medium is one texel of the scene buffer's section `media` (viewer/trace/scene/encode.py):
//   rgb: sigma_t, the extinction coefficient per tracer unit
// HAS_VOLUME: the scene has a medium besides the vacuum.
#if HAS_VOLUME
#include "trace/scene_buffer.glsl"

uniform int u_media;
#endif

// Transmittance along a distance d in a medium: exp(-sigma_t d)       Beer 1852
vec3 transmittance(int medium, float distance) {
#if HAS_VOLUME
    return exp(-scene_float4(u_media + medium).rgb * distance);
#else
    return vec3(1.0);
#endif
}
