// What media do to the light that arrives at a point: how much of each light and of the environment passes, and what
// they scatter there from all around. viewer/raster/media_light.py bakes the latter two on a coarse grid.
#if FOG
#include "media/fog.glsl"
#endif

uniform sampler3D u_media_light; // below: scattered radiance; above: opacity before the sky as a + b . direction
uniform vec4 u_media_grid;       // lowest corner of the grid in eye-relative units, and 1 / its side

vec4 media_light(vec3 p, float part) {
    vec3 uvw = clamp((p - u_media_grid.xyz) * u_media_grid.w, 0.0, 1.0);
    float margin = 0.5 / float(textureSize(u_media_light, 0).x);
    uvw.z = 0.5 * (clamp(uvw.z, margin, 1.0 - margin) + part);
    return textureLod(u_media_light, uvw, 0.0);
}

// Light that arrives at a point over a lobe, beside that of lights
struct MediaLight {
    vec3 scattered; // radiance that media have scattered
    float sky;      // transmittance to the environment
};

// `mean` is the mean direction of the lobe, of length 0 (all around) to 1. Scattered light is taken to come from where
// media hide the sky: the two add up to 1 in a white furnace.
MediaLight light_around(vec3 p, vec3 mean) {
    vec4 hidden = media_light(p, 1.0);
    float there = clamp(hidden.x + dot(hidden.yzw, mean), 0.0, 1.0);
    float share = hidden.x > 1e-20 ? there / hidden.x : 1.0;
    return MediaLight(media_light(p, 0.0).rgb * share, 1.0 - there);
}

// The optical depth from p to the distance `reach` along d
float media_depth(vec3 p, vec3 d, float reach) {
    float depth = 0.0;
#if FOG
    depth += fog_depth_ahead(p, d, reach);
#endif
    return depth;
}

float extinction_at(vec3 p) {
    float extinction = 0.0;
#if FOG
    extinction += fog_at(p);
#endif
    return extinction;
}

#if LIGHT_COUNT > 0
// The transmittance from p to light i of light/punctual.glsl, which lies in the direction l
float transmittance_to_light(int i, vec3 p, vec3 l) {
    return exp(-media_depth(p, l, i < DIRECTIONAL_COUNT ? 1e18 : distance(u_lights[i].position.xyz, p)));
}
#endif
