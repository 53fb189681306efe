// How much of a light arrives at a point of a medium: past the meshes of the scene, and through the media.
#if LIGHT_COUNT > 0
#include "light/punctual.glsl"
#endif
#if SHADOW_LAYERS > 0
#include "light/shadow.glsl"
#endif
#include "raster/lit_media.glsl"

#if LIGHT_COUNT > 0
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

// The share of light i, in the direction l, that arrives at p
float light_in_medium(int i, vec3 p, vec3 l) {
    return transmittance_to_light(i, p, l) * unshadowed_by_meshes(i, p);
}
#endif
