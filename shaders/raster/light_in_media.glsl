// How much of a light arrives at a point of a medium: past the meshes of the scene, and through the media.
#if LIGHT_COUNT > 0
#include "light/punctual.glsl"
#endif
#if SHADOW_LAYERS > 0
#include "light/shadow.glsl"
#endif
#include "raster/lit_media.glsl"
#if DENSE
#include "raster/volumes.glsl"
#endif

#if LIGHT_COUNT > 0
// The last of the point lights may stand for what volumes emit. They light fog, but no volumes: these know of it
// by their grid. So loops over lights in media have them at the end.
#define LIGHTS_IN_VOLUMES (LIGHT_COUNT - VOLUME_LIGHTS)
int light_in_media(int k) {
#if VOLUME_LIGHTS > 0
    const int FIRST = DIRECTIONAL_COUNT + POINT_COUNT - VOLUME_LIGHTS;
    if (k >= LIGHTS_IN_VOLUMES) return k - LIGHTS_IN_VOLUMES + FIRST;
    if (k >= FIRST) return k + VOLUME_LIGHTS;
#endif
    return k;
}

// The share of light i that no mesh keeps from p
float unshadowed_by_meshes(int i, vec3 p) {
#if SHADOW_LAYERS > 0
    float layer = u_lights[i].direction.w;
    if (layer >= 0.0) {
        bool is_point = i >= DIRECTIONAL_COUNT && i < DIRECTIONAL_COUNT + POINT_COUNT;
        return shadow_in_medium(int(layer), is_point, p, u_lights[i].position.xyz);
    }
#endif
    return 1.0;
}

#if DENSE
uniform float u_volume_near; // how far volumes are looked at themselves: the coarse grid of depths has no faces

// The optical depth of the volumes up to the distance `reach`, in parts that are the shorter the nearer they are.
// Simpson's rule has no error in the mean where the extinction is linear up to a face, and 0 behind.
float near_depth(vec3 p, vec3 l, float reach) {
    const float PARTS = 2.0;
    float depth = 0.0, start = volumes_at(p);
    for (float k = 0.0; k < PARTS; ++k) {
        vec2 part = reach / (PARTS * PARTS) * vec2(k * k, (k + 1.0) * (k + 1.0));
        float end = volumes_at(p + part.y * l), middle = volumes_at(p + 0.5 * (part.x + part.y) * l);
        depth += (part.y - part.x) * (start + 4.0 * middle + end) / 6.0;
        start = end;
    }
    return depth;
}
#endif

// The share of light i, in the direction l, that arrives at p
float light_in_medium(int i, vec3 p, vec3 l) {
#if DENSE
    float reach = i < DIRECTIONAL_COUNT ? 1e18 : distance(u_lights[i].position.xyz, p);
    float arriving = exp(-near_depth(p, l, min(u_volume_near, reach))) * transmittance_to_light(i, p, l, u_volume_near);
#else
    float arriving = transmittance_to_light(i, p, l);
#endif
    return arriving * unshadowed_by_meshes(i, p);
}
#endif
