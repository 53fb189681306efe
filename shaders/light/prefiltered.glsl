// The prefiltered environment: a mip chain made by viewer/bake/prefilter.py, with one level for each of six
// roughnesses. The lobe of roughness 1 is that of the cosine, so a lobe between it and one that is wider is looked up
// in the irradiance, which has the wider one as its mip level 1.
#include "light/equirect.glsl"

const float WIDEST_PREFILTERED = 5.0; // the level of roughness 1

// The level is piecewise linear in x = alpha / (alpha + 0.4), with one ramp per level. The resulting blend of two
// levels is close to the best one for a roughness in between. The levels are filtered for perceptual roughness 0, 0.12,
// 0.22, 0.36, 0.58, 1 (LEVEL_ROUGHNESS in prefilter.py; a test compares the two).
float lod_of_roughness(float perceptual_roughness) {
    float alpha = perceptual_roughness * perceptual_roughness;
    float x = alpha / (alpha + 0.4);
    vec4 ramps = clamp(x * vec4(28.777778, 13.663012, 7.311350, 4.714669)
                       - vec4(0.0, 0.474776, 0.789182, 1.153741), 0.0, 1.0);
    return dot(ramps, vec4(1.0)) + clamp(x * 3.883966 - 1.774262, 0.0, 1.0);
}

// d: unit length, in the environment's frame.
vec3 prefiltered_radiance(sampler2D map, vec3 d, float lod) {
    return textureLod(map, equirect_uv_with_margin(d), lod).rgb;
}
