// The light that a point of a medium scatters towards the eye: of punctual lights and suns with their shadows, of the
// environment, and of what was scattered before (lit_media.glsl).
#include "media/any_phase.glsl"
#include "raster/light_in_media.glsl"
#if VOLUMES > 0
#include "raster/volumes.glsl"
#endif
#if SKY_SHADOWS || LIT_MESHES
#include "raster/past_meshes.glsl"
#endif
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"

uniform vec3 u_sky_intensity;
// The environment convolved with the phase functions of fog and volumes (viewer/bake/phase.py)
uniform sampler2D u_sky_in_fog, u_sky_in_volumes;

// What a point scatters to the eye of an environment that nothing hides: the integral of L(w) p(w . d), and those of
// L(w) w p(w . d), which each have one component of w in a column
struct Sky {
    vec3 mean;
    mat3 moments;
};

Sky scattered_sky(sampler2D map, vec3 direction) {
    vec2 uv = equirect_uv_with_margin(to_environment(direction));
    vec3 maps[4];
    for (int k = 0; k < 4; ++k)
        maps[k] = u_sky_intensity * textureLod(map, vec2(uv.x, 0.25 * (uv.y + float(k))), 0.0).rgb;
    return Sky(maps[0], mat3(maps[1], maps[2], maps[3]));
}

// The same where media hide a + b . w of it. As no point gets more than all of the light, what a fit has too much is
// cut.
vec3 seen_sky(Sky sky, vec4 hidden) {
    vec3 light = sky.mean * (1.0 - hidden.x) - sky.moments * to_environment(hidden.yzw);
    return clamp(light, vec3(0.0), sky.mean);
}
#endif

// How a medium scatters
struct Scattering {
    vec3 albedo;
    float mean_cosine;
    vec4 of_lights; // albedo, and the phase function (media/any_phase.glsl), of light of lights
    vec3 emission; // radiance for each optical depth
#if LIGHT_COUNT > 0
    int light_count;
#endif
#if HAS_ENVIRONMENT
    Sky sky;
#endif
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
uniform vec4 u_fog_scattering; // albedo, mean cosine
uniform vec4 u_fog_of_lights;

Scattering fog_scattering(vec3 direction) {
    Scattering medium;
    medium.albedo = u_fog_scattering.rgb;
    medium.mean_cosine = u_fog_scattering.a;
    medium.of_lights = u_fog_of_lights;
    medium.emission = vec3(0.0);
#if LIGHT_COUNT > 0
    medium.light_count = LIGHT_COUNT;
#endif
#if HAS_ENVIRONMENT
    medium.sky = scattered_sky(u_sky_in_fog, direction);
#endif
    return medium;
}
#endif

#if VOLUMES > 0
uniform vec4 u_volume_scattering; // albedo, mean cosine
uniform vec4 u_volume_of_lights;
uniform vec3 u_volume_emission;

Scattering volume_scattering(vec3 direction) {
    Scattering medium;
    medium.albedo = u_volume_scattering.rgb;
    medium.mean_cosine = u_volume_scattering.a;
    medium.of_lights = u_volume_of_lights;
    medium.emission = u_volume_emission;
#if LIGHT_COUNT > 0
    medium.light_count = LIGHTS_IN_VOLUMES;
#endif
#if HAS_ENVIRONMENT
    medium.sky = scattered_sky(u_sky_in_volumes, direction);
#endif
    return medium;
}
#endif

#if LIGHT_COUNT > 0
// The mean of D^2 / d^2 over a step, with d the distance to a light and D that at the point `at`. From a point, the
// step is seen under an angle theta, and the mean of 1 / d^2 is theta / (h length), with h the distance of the ray from
// it (Kulla & Fajardo 2012). So a light in the middle of a fog needs no more steps than any other.
float near_light(Ray ray, int i, float from, float to, float at) {
    vec3 to_light = u_lights[i].position.xyz - ray.origin;
    float middle = dot(to_light, ray.direction);
    vec3 across = to_light - middle * ray.direction;
    float h2 = max(dot(across, across), u_lights[i].cone.z), h = sqrt(h2); // as in light/attenuation.glsl
    float a = from - middle, b = to - middle, d = at - middle;
    float theta = atan(h * (b - a), h2 + a * b);
    return (h2 + d * d) * theta / (h * max(b - a, 1e-20));
}

#if DENSE
#include "raster/dense_light.glsl"

uniform float u_volume_cell; // length of a cell of the grid; 0 where light is scattered once

// Radiance that light of this irradiance E, the share `arriving` of which comes to p from the direction l, makes there
// by being scattered more than once. The nearest face lies where the media hide least, at the end of `hidden`.
vec3 light_below_face(vec3 irradiance, float arriving, vec3 p, vec3 l, vec3 hidden, Scattering medium) {
    float share = beyond_grid(u_volume_cell * volumes_at(p));
    float along = -log(max(arriving, 1e-30));
    float mu = clamp(-dot(hidden, l) * inversesqrt(max(dot(hidden, hidden), 1e-20)), 0.05, 1.0);
    vec3 phi;
    for (int k = 0; k < 3; ++k) phi[k] = half_space_fluence(medium.albedo[k], medium.mean_cosine, mu, mu * along);
    return share * (0.25 * INV_PI) * phi * irradiance;
}
#endif
#endif

// The source function: radiance that one optical depth of the medium adds, at the distance `at` of a step
vec3 source(Ray ray, float at, float from, float to, Scattering medium) {
    vec3 p = ray.origin + at * ray.direction;
    MediaLight around = light_around(p, medium.mean_cosine * ray.direction);
#if SKY_SHADOWS || LIT_MESHES
    PastMeshes past = past_meshes(p);
    around.scattered *= past.left;
#endif
#if SKY_SHADOWS
    around.hidden = past.hidden;
#endif
    vec3 sum = around.scattered;
#if LIT_MESHES
    sum += past.reflected;
#endif
#if EMITS
    int last = textureSize(u_media_light, 0).z / textureSize(u_media_light, 0).x - 1;
    if (medium.emission != vec3(0.0)) sum += part_of_cubes(u_media_light, in_grid(u_volume_grid, p), last).rgb;
#endif
#if HAS_ENVIRONMENT
    sum += seen_sky(medium.sky, around.hidden);
#endif
    sum *= medium.albedo;
#if LIGHT_COUNT > 0
    int k = 0;
    if (medium.light_count > 0) do {
        int i = light_in_media(k);
        vec3 l;
        vec3 irradiance = punctual_irradiance(i, p, l);
        if (i >= DIRECTIONAL_COUNT) irradiance *= near_light(ray, i, from, to, at);
        float arriving = light_in_medium(i, p, l);
        float scattered = any_phase(medium.of_lights.a, -l, -ray.direction) * arriving;
        sum += medium.of_lights.rgb * irradiance * scattered;
#if DENSE
        sum += medium.albedo * light_below_face(irradiance, arriving, p, l, around.hidden.yzw, medium);
#endif
    } while (++k < medium.light_count);
#endif
    return sum + medium.emission;
}
