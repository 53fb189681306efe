// The environment as a surface sees it: rotated about +Y and scaled. Its suns are left out; they are lights of their
// own.
#include "light/environment_rotation.glsl"
#include "light/irradiance.glsl"

uniform float u_environment_intensity;
uniform sampler2D u_irradiance;
#if REFLECTS
#include "light/prefiltered.glsl"

uniform sampler2D u_prefiltered;
#endif

vec3 environment_irradiance_over_pi(vec3 n) {
    return u_environment_intensity * irradiance_over_pi(u_irradiance, to_environment(n));
}

#if REFLECTS
vec3 environment_level(vec3 d, float lod) {
    return u_environment_intensity * prefiltered_radiance(u_prefiltered, to_environment(d), lod);
}

// The same for levels up to the widest. llvmpipe looks both maps up, so it is for those that may be so wide.
vec3 environment_wide_level(vec3 d, float lod) {
    vec3 wide = wide_radiance(u_irradiance, to_environment(d), max(lod - WIDEST_PREFILTERED, 0.0));
    return lod > WIDEST_PREFILTERED ? u_environment_intensity * wide : environment_level(d, lod);
}

vec3 environment_specular(vec3 d, float perceptual_roughness) {
    return environment_level(d, lod_of_roughness(perceptual_roughness));
}
#endif
