// Lights without size: LIGHT_COUNT of them, first DIRECTIONAL_COUNT directional, then POINT_COUNT point, the rest spot.
// All positions are relative to the eye and in scene units (see viewer/raster/frame.py).
struct PunctualLight {
    vec4 position;  // xyz; w = 1 / range^2, 0 where unlimited
    vec4 direction; // xyz: where the light travels to; w = first shadow layer, -1 without shadow
    vec4 intensity; // rgb: lux (directional) or candela; w unused
    vec4 cone;      // x scale, y offset of the spot's angular attenuation
};

layout(std140) uniform Lights {
    PunctualLight u_lights[LIGHT_COUNT];
};

// 1 / d^2, windowed by range: clamp(1 - (d / range)^4)       KHR_lights_punctual, "Range Property"
// The floor protects a surface that touches the light: 1e-8 is a ten-thousandth of the scene's radius, squared.
float distance_attenuation(float d2, float inv_range2) {
    float x = d2 * inv_range2;
    return clamp(1.0 - x * x, 0.0, 1.0) / max(d2, 1e-8);
}

// clamp(cos * scale + offset)^2                        KHR_lights_punctual, "Inner and Outer Cone Angles"
float angular_attenuation(float cos_angle, vec2 cone) {
    float a = clamp(cos_angle * cone.x + cone.y, 0.0, 1.0);
    return a * a;
}

// Direction to light i from p, and the irradiance it would give a surface facing it, without shadow.
vec3 punctual_irradiance(int i, vec3 p, out vec3 l) {
    PunctualLight light = u_lights[i];
#if DIRECTIONAL_COUNT > 0
    if (i < DIRECTIONAL_COUNT) {
        l = -light.direction.xyz;
        return light.intensity.rgb;
    }
#endif
#if LIGHT_COUNT > DIRECTIONAL_COUNT
    vec3 d = light.position.xyz - p;
    float d2 = dot(d, d);
    l = d * inversesqrt(max(d2, 1e-30));
    float attenuation = distance_attenuation(d2, light.position.w);
#if LIGHT_COUNT > DIRECTIONAL_COUNT + POINT_COUNT
    if (i >= DIRECTIONAL_COUNT + POINT_COUNT) attenuation *= angular_attenuation(-dot(l, light.direction.xyz), light.cone.xy);
#endif
    return light.intensity.rgb * attenuation;
#endif
}
