// The material at a fragment, its coverage by alpha, and the output of the fragment.
#include "raster/varying.glsl"
#include "material/uniforms.glsl"
#if MEDIA
#include "raster/in_media.glsl"
#endif

VARYING vec3 v_position; // relative to the eye

layout(location = 0) out vec4 o_color; // radiance with associated alpha

// ALPHA_MODE: 0 opaque, 1 mask, 2 blend. In mode mask, alpha becomes the fraction of the pixel's samples that is
// covered, with a transition of one pixel about the cutoff (Golus 2017, "Anti-aliased Alpha Test"). Alpha to coverage
// uses it. Where alpha is constant, or cannot cross the cutoff, alpha >= cutoff is opaque (glTF 2.0, 3.9.4).
float coverage(float alpha) {
#if ALPHA_MODE == 0
    return 1.0;
#elif ALPHA_MODE == 1
    float covered = alpha < u_alpha_cutoff ? 0.0 : 1.0;
#if SAMPLES > 1
    float width = fwidth(alpha);
    if (width > 1e-4 && u_alpha_cutoff > 0.0 && u_alpha_cutoff <= 1.0)
        covered = clamp((alpha - u_alpha_cutoff) / width + 0.5, 0.0, 1.0);
#endif
    return covered;
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

// In mode mask, alpha only selects samples (alpha to coverage), so radiance is not multiplied by it.
void write_radiance(vec3 radiance, float covered) {
#if MEDIA
    radiance = seen_in_media(radiance, v_position);
#endif
#if HALF_TARGET
    radiance = min(radiance, vec3(65504.0)); // the largest finite half float
#endif
#if ALPHA_MODE == 1
    o_color = vec4(radiance, covered);
#else
    o_color = vec4(radiance * covered, covered);
#endif
    drop_uncovered(covered);
}
