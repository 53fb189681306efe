// Punctual lights: LIGHT_COUNT in all, first DIRECTIONAL_COUNT directional ones, then POINT_COUNT point lights, then
// spots. Positions are in eye-relative space (viewer/scene/frame.py).
#include "light/attenuation.glsl"

struct PunctualLight {
    vec4 position;  // xyz; w = 1 / range^2, 0 where unlimited
    vec4 direction; // xyz: direction in which the light travels; w = first shadow layer, or -1 without shadow
    vec4 intensity; // rgb: lux (directional) or candela; w: square of a sun's radius in radians, else 0
    vec4 cone;      // x scale, y offset of the spot's angular attenuation; z: least squared distance that counts
};

layout(std140) uniform Lights {
    PunctualLight u_lights[LIGHT_COUNT];
};

// The irradiance of light i at p on a surface that faces it, without shadow. l is the direction from p to the light.
vec3 punctual_irradiance(int i, vec3 p, out vec3 l) {
    PunctualLight light = u_lights[i];
#if LIGHT_COUNT == DIRECTIONAL_COUNT
    l = -light.direction.xyz;
    return light.intensity.rgb;
#else
#if DIRECTIONAL_COUNT > 0
    if (i < DIRECTIONAL_COUNT) {
        l = -light.direction.xyz;
        return light.intensity.rgb;
    }
#endif
    vec3 d = light.position.xyz - p;
    float d2 = dot(d, d);
    l = d * inversesqrt(max(d2, 1e-30));
    float attenuation = distance_attenuation(d2, light.position.w, light.cone.z);
#if LIGHT_COUNT > DIRECTIONAL_COUNT + POINT_COUNT
    if (i >= DIRECTIONAL_COUNT + POINT_COUNT) {
        attenuation *= angular_attenuation(-l, light.direction.xyz, light.cone.xy);
    }
#endif
    return light.intensity.rgb * attenuation;
#endif
}
