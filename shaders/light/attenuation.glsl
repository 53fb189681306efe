// Attenuation of punctual lights by distance and by the angle to a spot's axis (KHR_lights_punctual).
#include "sample/one_minus_cosine.glsl"

// 1 / d^2, windowed by range: clamp(1 - (d / range)^4)       KHR_lights_punctual, "Range Property"
// The least d2 prevents a division by 0 at the light.
float distance_attenuation(float d2, float inv_range2, float least) {
    float x = d2 * inv_range2;
    return clamp(1.0 - x * x, 0.0, 1.0) / max(d2, least);
}

// clamp(offset - scale (1 - cos))^2 of the angle between the direction of light and a spot's axis, both of length 1
// (`Light.cone` has scale and offset)                  KHR_lights_punctual, "Inner and Outer Cone Angles"
float angular_attenuation(vec3 direction, vec3 axis, vec2 cone) {
    float a = clamp(cone.y - cone.x * one_minus_cosine(direction, axis), 0.0, 1.0);
    return a * a;
}
