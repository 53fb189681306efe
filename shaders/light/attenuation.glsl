// Attenuation of punctual lights by distance and by the angle to a spot's axis (KHR_lights_punctual).

// 1 / d^2, windowed by range: clamp(1 - (d / range)^4)       KHR_lights_punctual, "Range Property"
// The minimum of d2 prevents a division by 0 at the light: 1e-8 is (1e-4 of the scene's radius)^2.
float distance_attenuation(float d2, float inv_range2) {
    float x = d2 * inv_range2;
    return clamp(1.0 - x * x, 0.0, 1.0) / max(d2, 1e-8);
}

// clamp(cos * scale + offset)^2                        KHR_lights_punctual, "Inner and Outer Cone Angles"
float angular_attenuation(float cos_angle, vec2 cone) {
    float a = clamp(cos_angle * cone.x + cone.y, 0.0, 1.0);
    return a * a;
}
