// The light that a point of a medium scatters towards the eye: of punctual lights and suns with their shadows, of the
// environment, and of what was scattered before (lit_media.glsl).
#include "media/phase.glsl"
#include "raster/light_in_media.glsl"
#if VOLUMES > 0
#include "raster/volumes.glsl"
#endif
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"

uniform vec3 u_sky_intensity;
// The environment convolved with the phase functions of fog and volumes (viewer/bake/phase.py)
uniform sampler2D u_sky_in_fog, u_sky_in_volumes;

vec3 scattered_sky(sampler2D map, vec3 direction) {
    return u_sky_intensity * irradiance_over_pi(map, to_environment(direction));
}
#endif

// How a medium scatters
struct Scattering {
    vec3 albedo;
    float g;
    vec3 emission; // radiance for each optical depth
    vec3 sky;      // the environment's radiance that it would scatter to the eye if it hid none of it
};

struct Ray {
    vec3 origin, direction;
#if FOG
    vec2 fog; // where it is in the fog
#endif
#if VOLUMES > 0
    vec2 volumes[VOLUMES];
#endif
};

Ray ray_through(vec3 origin, vec3 direction) {
    Ray ray;
    ray.origin = origin;
    ray.direction = direction;
#if FOG
    ray.fog = fog_span(origin, direction);
#endif
#if VOLUMES > 0
    for (int k = 0; k < VOLUMES; ++k) ray.volumes[k] = volume_span(k, origin, direction);
#endif
    return ray;
}

#if FOG
uniform vec4 u_fog_scattering; // albedo, g

Scattering fog_scattering(vec3 direction) {
    vec3 sky = vec3(0.0);
#if HAS_ENVIRONMENT
    sky = scattered_sky(u_sky_in_fog, direction);
#endif
    return Scattering(u_fog_scattering.rgb, u_fog_scattering.a, vec3(0.0), sky);
}
#endif

#if VOLUMES > 0
uniform vec4 u_volume_scattering; // albedo, g
uniform vec3 u_volume_emission;

Scattering volume_scattering(vec3 direction) {
    vec3 sky = vec3(0.0);
#if HAS_ENVIRONMENT
    sky = scattered_sky(u_sky_in_volumes, direction);
#endif
    return Scattering(u_volume_scattering.rgb, u_volume_scattering.a, u_volume_emission, sky);
}
#endif

#if LIGHT_COUNT > 0
// The mean of D^2 / d^2 over a step, with d the distance to a light and D that at the point `at`. From a point, the step
// is seen under an angle theta, and the mean of 1 / d^2 is theta / (h length), with h the distance of the ray from it
// (Kulla & Fajardo 2012). So a light in the middle of a fog needs no more steps than any other.
float near_light(Ray ray, vec3 position, float from, float to, float at) {
    vec3 to_light = position - ray.origin;
    float middle = dot(to_light, ray.direction);
    vec3 across = to_light - middle * ray.direction;
    float h2 = max(dot(across, across), 1e-8), h = sqrt(h2); // the same bound as in light/attenuation.glsl
    float a = from - middle, b = to - middle, d = at - middle;
    float theta = atan(h * (b - a), h2 + a * b);
    return (h2 + d * d) * theta / (h * max(b - a, 1e-20));
}

#endif

// The source function: radiance that one optical depth of the medium adds, at the distance `at` of a step
vec3 source(Ray ray, float at, float from, float to, Scattering medium) {
    vec3 p = ray.origin + at * ray.direction;
    MediaLight around = light_around(p, medium.g * ray.direction);
    vec3 sum = around.scattered + medium.sky * around.sky;
#if LIGHT_COUNT > 0
    for (int i = 0; i < LIGHT_COUNT; ++i) {
        vec3 l;
        vec3 irradiance = punctual_irradiance(i, p, l);
        if (i >= DIRECTIONAL_COUNT) irradiance *= near_light(ray, u_lights[i].position.xyz, from, to, at);
        sum += irradiance * (phase_between(medium.g, -l, -ray.direction) * light_in_medium(i, p, l));
    }
#endif
    return medium.albedo * sum + medium.emission;
}
