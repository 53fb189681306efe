// The medium of a volume, from its record (media/grid.glsl). It is open: light comes and goes through its box.
#include "media/medium.glsl"

uniform int u_volumes;

Medium volume_medium(int k) {
    int texel = u_volumes + k * VOLUME_TEXELS;
    vec4 scattered = scene_float4(texel + 6);
    return Medium(vec3(uintBitsToFloat(scene_uint4(texel + 5).y)), scattered.rgb, scattered.a, true);
}

// What a collision adds of the volume's emission: emission / sigma_t, both of one density
vec3 volume_emission(int k) {
    return scene_float4(u_volumes + k * VOLUME_TEXELS + 7).rgb;
}
