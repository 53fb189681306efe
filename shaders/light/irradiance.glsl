// The irradiance map of an environment, made by viewer/bake/irradiance.py.
#include "light/equirect.glsl"

// Irradiance / pi. n: unit length, in the environment's frame.
vec3 irradiance_over_pi(sampler2D map, vec3 n) {
    return textureLod(map, equirect_uv_with_margin(n), 0.0).rgb;
}
