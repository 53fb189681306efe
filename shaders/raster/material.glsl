// The material at a fragment: factors, vertex colours and maps multiplied out as glTF 2.0 says.
#include "raster/textures.glsl"

in vec3 v_position; // relative to the eye
#if HAS_COLOR
in vec4 v_color;
#endif

uniform vec4 u_base_color;
#if HAS_EMISSIVE
uniform vec3 u_emissive;
#endif
#if ALPHA_MODE == 1
uniform float u_alpha_cutoff;
#endif

layout(location = 0) out vec4 o_color; // radiance with associated alpha

vec4 base_color() {
    vec4 c = u_base_color;
#if BASE_COLOR_MAP
    c *= base_color_texel();
#endif
#if HAS_COLOR
    c *= v_color;
#endif
    return c;
}

vec3 emitted() {
#if HAS_EMISSIVE
    vec3 e = u_emissive;
#if EMISSIVE_MAP
    e *= emissive_texel().rgb;
#endif
    return e;
#else
    return vec3(0.0);
#endif
}

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
