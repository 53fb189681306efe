// What media do to the light that arrives at a point: how much of each light and of the environment passes, and what
// they scatter there from all around. viewer/raster/media_light.py bakes the latter two on a coarse grid.
#if FOG
#include "media/fog.glsl"
#endif

#if VOLUMES > 0
uniform sampler3D u_volume_depth; // optical depth of volumes towards each light, four lights in each part along z
#endif

// A grid about the fog, and one about the volumes. Each has three parts of the texture, one above the other along z:
// scattered radiance, and opacity as a + b . direction, before the light of the environment and all around. Above them
// all stand those of in_scattered.glsl.
#define GRIDS (FOG + (VOLUMES > 0 ? 1 : 0))
uniform sampler3D u_media_light;
uniform vec4 u_fog_grid, u_volume_grid; // lowest corner in eye-relative units, and 1 / side

vec3 in_grid(vec4 grid, vec3 p) {
    return (p - grid.xyz) * grid.w;
}

bool is_inside(vec3 uvw) {
    return min(uvw.x, min(uvw.y, uvw.z)) >= 0.0 && max(uvw.x, max(uvw.y, uvw.z)) <= 1.0;
}

// A part of a texture of cubes that lie one above the other along z
vec4 part_of_cubes(sampler3D cubes, vec3 uvw, int part) {
    ivec3 size = textureSize(cubes, 0);
    float margin = 0.5 / float(size.x), count = float(size.z / size.x);
    return textureLod(cubes, vec3(uvw.xy, (clamp(uvw.z, margin, 1.0 - margin) + float(part)) / count), 0.0);
}

// Light that arrives at a point over a lobe, beside that of lights
struct MediaLight {
    vec3 scattered; // radiance that media have scattered
    float sky;      // transmittance to the environment
    vec4 hidden;    // opacity before the environment as a + b . direction
};

// `mean` is the mean direction of the lobe, of length 0 (all around) to 1. Scattered light is taken to come from where
// media hide what is around, and more of it from where it flows from (viewer/bake/diffusion.py). In a white furnace it
// and the sky add up to 1.
MediaLight light_around(vec3 p, vec3 mean) {
    int first = 0;
#if VOLUMES > 0
    vec3 uvw = in_grid(u_volume_grid, p);
    if (is_inside(uvw)) first = 3 * FOG;
#if FOG
    else uvw = in_grid(u_fog_grid, p);
#else
    else return MediaLight(vec3(0.0), 1.0, vec4(0.0));
#endif
#else
    vec3 uvw = in_grid(u_fog_grid, p);
#endif
    vec4 hidden = part_of_cubes(u_media_light, uvw, first + 1);
    float fade = 1.0;
#if VOLUMES > 0 && !FOG // beside the volumes their light fades out to the edge of the grid
    vec3 inside = min(uvw, 1.0 - uvw);
    fade = clamp(min(inside.x, min(inside.y, inside.z)) * 12.0, 0.0, 1.0);
#endif
    hidden *= fade;
    float share = fade;
    if (mean != vec3(0.0)) {
        vec4 opacity = part_of_cubes(u_media_light, uvw, first + 2);
        float from_there = clamp(opacity.x + dot(opacity.yzw, mean), 0.0, max(1.0, 2.0 * opacity.x));
        share *= opacity.x > 1e-20 ? from_there / opacity.x : 1.0;
    }
    return MediaLight(part_of_cubes(u_media_light, uvw, first).rgb * share,
                      1.0 - clamp(hidden.x + dot(hidden.yzw, mean), 0.0, 1.0), hidden);
}

#if VOLUMES > 0 && LIGHT_COUNT > 0
// The optical depth of the volumes from p to light i, in the direction l. Outside of the grid it is that of the point
// where the ray enters it.
float volumes_depth_to_light(int i, vec3 p, vec3 l, float reach) {
    vec3 at = in_grid(u_volume_grid, p);
    if (!is_inside(at)) {
        vec3 direction = mix(l, vec3(1e-20), lessThan(abs(l), vec3(1e-20))) * u_volume_grid.w;
        vec3 a = -at / direction, b = (1.0 - at) / direction;
        vec3 low = min(a, b), high = max(a, b);
        float from = max(low.x, max(low.y, low.z)), to = min(high.x, min(high.y, high.z));
        if (from >= to || from < 0.0 || from >= reach) return 0.0;
        at += from * direction;
    }
    vec4 depths = part_of_cubes(u_volume_depth, clamp(at, 0.0, 1.0), i / 4);
    return max(depths[i % 4], 0.0);
}
#endif

#if LIGHT_COUNT > 0
// The transmittance from p to light i of light/punctual.glsl, which lies in the direction l, without the volumes that
// are less than `skipped` away
float transmittance_to_light(int i, vec3 p, vec3 l, float skipped) {
    float reach = i < DIRECTIONAL_COUNT ? 1e18 : distance(u_lights[i].position.xyz, p), depth = 0.0;
#if FOG
    depth += fog_depth_ahead(p, l, reach);
#endif
#if VOLUMES > 0
    if (skipped < reach) depth += volumes_depth_to_light(i, p + skipped * l, l, reach - skipped);
#endif
    return exp(-depth);
}

float transmittance_to_light(int i, vec3 p, vec3 l) {
    return transmittance_to_light(i, p, l, 0.0);
}
#endif
