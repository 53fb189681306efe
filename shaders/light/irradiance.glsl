// The irradiance map of an environment, made by viewer/bake/irradiance.py.
#include "light/equirect.glsl"

// Between irradiance / pi (0) and the radiance in the widest lobe of viewer/bake/prefilter.py (1)
vec3 wide_radiance(sampler2D map, vec3 d, float lod) {
    return textureLod(map, equirect_uv_with_margin(d), lod).rgb;
}

// Irradiance / pi. n: unit length, in the environment's frame.
vec3 irradiance_over_pi(sampler2D map, vec3 n) {
    return wide_radiance(map, n, 0.0);
}
