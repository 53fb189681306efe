// ALPHA_MODE 1: the share of a pixel or of its samples that a mask covers, and which of them.
#ifndef SAMPLES
#define SAMPLES 1
#endif

#if BASE_COLOR_MAP
uniform int u_mask_levels; // of the map: 0 have the mean alpha or do not exist; 1 and 2 have the share that stands
                           // (viewer/scene/mask_levels.py), and lookups take the nearest level or the means of two

// How far lookups are beyond the first level: 0 there, 1 in all levels but it
float beyond_first_level() {
    vec2 size = vec2(textureSize(u_base_color_map, 0));
    vec2 texel = size * map_uv(BASE_COLOR_UV, BASE_COLOR_TRANSFORM, u_base_color_transform, BASE_COLOR_MIRROR);
    vec2 x = dFdx(texel), y = dFdy(texel);
    float level = 0.5 * log2(max(max(dot(x, x), dot(y, y)), 1e-9));
    return clamp(u_mask_levels == 1 ? floor(level + 0.5) : level, 0.0, 1.0);
}
#else
const int u_mask_levels = 0;
float beyond_first_level() {
    return 0.0;
}
#endif

// 16 thresholds in (0, 1) that repeat every four pixels, those of each 2 x 2 as different as can be (Bayer 1973). Their
// phase depends on the triangle, so that masks behind each other do not all stand in the same pixels.
float mask_threshold() {
    ivec2 p = ivec2(gl_FragCoord.xy) & 3;
    int fine = (p.x ^ p.y) & 1, coarse = (p.x ^ p.y) >> 1;
    int order = fine << 3 | (p.y & 1) << 2 | coarse << 1 | p.y >> 1;
    uint phase = uint(gl_PrimitiveID) * 2654435769u >> 28u;
    return fract((float(order) + float(phase) + 0.5) / 16.0);
}

// In the first level of the map alpha >= cutoff is covered (glTF 2.0, 3.9.4), with several samples by a transition of
// one pixel about the cutoff (Golus 2017, "Anti-aliased Alpha Test"); where alpha is constant, or cannot cross the
// cutoff, there is none. In smaller levels alpha is the share already, but for `factor`, which multiplies the map's.
float mask_share(float alpha, float factor, float beyond) {
    float width = 0.0;
#if SAMPLES > 1
    width = fwidth(alpha);
#endif
    if (beyond > 0.0) {
        float cutoff = mix(u_alpha_cutoff, 0.5 * factor, beyond);
        return clamp((alpha - cutoff) / max(mix(width, factor, beyond), 1e-9) + 0.5, 0.0, 1.0);
    }
    if (width > 1e-4 && u_alpha_cutoff > 0.0 && u_alpha_cutoff <= 1.0)
        return clamp((alpha - u_alpha_cutoff) / width + 0.5, 0.0, 1.0);
    return alpha < u_alpha_cutoff ? 0.0 : 1.0;
}

// The share of the samples that is covered: of one all or nothing, by its threshold
float mask_coverage(float alpha) {
    float factor = u_base_color.a;
#if HAS_COLOR
    factor *= v_color.a;
#endif
    float beyond = u_mask_levels > 0 && factor >= u_alpha_cutoff ? beyond_first_level() : 0.0;
    float samples = float(SAMPLES);
    float count = floor(mask_share(alpha, factor, beyond) * samples + mix(0.5, mask_threshold(), beyond));
    return min(count, samples) / samples;
}
