// The material at a fragment, its coverage by alpha, and the output of the fragment.
#include "raster/varying.glsl"
#include "material/uniforms.glsl"
#if ALPHA_MODE == 1
#include "raster/alpha_mask.glsl"
#endif
#if MEDIA
#include "raster/in_media.glsl"
#endif

VARYING vec3 v_position; // relative to the eye

layout(location = 0) out vec4 o_color; // radiance with associated alpha

// ALPHA_MODE: 0 opaque, 1 mask, 2 blend. In mode mask it is the share of the pixel's samples.
float coverage(float alpha) {
#if ALPHA_MODE == 0
    return 1.0;
#elif ALPHA_MODE == 1
    return mask_coverage(alpha);
#else
    return clamp(alpha, 0.0, 1.0);
#endif
}

// Ends a fragment that nothing covers. It is the last that a shader does: after a discard, derivatives and the texture
// lookups that take their level from them are undefined in the neighbouring pixels (GLSL 3.30, 6.4).
void drop_uncovered(float covered) {
#if ALPHA_MODE == 1
    if (covered <= 0.0) discard;
#endif
}

// In mode mask, alpha only selects samples (alpha to coverage), so radiance is not multiplied by it. Drivers round it up
// or to the nearest count of samples: to all, a little less than a count is that count.
void write_radiance(vec3 radiance, float covered) {
#if MEDIA
    radiance = seen_in_media(radiance, v_position);
#endif
#if HALF_TARGET
    radiance = min(radiance, vec3(65504.0)); // the largest finite half float
#endif
#if ALPHA_MODE == 1
    o_color = vec4(radiance, SAMPLES > 1 ? covered - 0.4 / float(SAMPLES) : covered);
#else
    o_color = vec4(radiance * covered, covered);
#endif
    drop_uncovered(covered);
}
