// The material at a fragment, how much of the fragment it covers, and what the fragment writes.
#include "material/uniforms.glsl"

in vec3 v_position; // relative to the eye

layout(location = 0) out vec4 o_color; // radiance with associated alpha

// ALPHA_MODE: 0 opaque, 1 mask, 2 blend. A mask's alpha becomes the share of the pixel's samples that are covered, one
// pixel of transition about the cutoff (Golus 2017, "Anti-aliased Alpha Test"): the multisample target does the rest.
float coverage(float alpha) {
#if ALPHA_MODE == 0
    return 1.0;
#elif ALPHA_MODE == 1
    float covered = clamp((alpha - u_alpha_cutoff) / max(fwidth(alpha), 1e-4) + 0.5, 0.0, 1.0);
#if SAMPLES == 1
    covered = alpha < u_alpha_cutoff ? 0.0 : 1.0;
#endif
    if (covered <= 0.0) discard;
    return covered;
#else
    return clamp(alpha, 0.0, 1.0);
#endif
}

// With a mask alpha only selects samples (alpha to coverage); the radiance itself is whole.
void write_radiance(vec3 radiance, float covered) {
#if HALF_TARGET
    radiance = min(radiance, vec3(65504.0)); // the largest half float; beyond it lies infinity
#endif
#if ALPHA_MODE == 1
    o_color = vec4(radiance, covered);
#else
    o_color = vec4(radiance * covered, covered);
#endif
}
