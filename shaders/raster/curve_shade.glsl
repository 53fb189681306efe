// What the shading models of curves share: the point of the strip, the light that comes to it, and the output.
#include "raster/curve_frame.glsl"
#if LIGHT_COUNT > 0
#include "light/punctual.glsl"
#endif
#if SHADOW_LAYERS > 0
#include "light/shadow.glsl"
#endif
#if MEDIA
#include "raster/in_media.glsl"
#include "raster/lit_media.glsl"
#endif
#if HAS_COLORS
in vec3 v_sigma_a;
#else
uniform vec3 u_sigma_a;
#endif

layout(location = 0) out vec4 o_color;

vec3 absorption() {
#if HAS_COLORS
    return v_sigma_a;
#else
    return u_sigma_a;
#endif
}

#if LIGHT_COUNT > 0
// Of light i, from the direction l, before its shadow
vec3 light_before_shadow(int i, CurvePoint at, out vec3 l) {
    vec3 irradiance = punctual_irradiance(i, at.position, l);
#if MEDIA
    irradiance *= transmittance_to_light(i, at.position, l);
#endif
    return irradiance;
}

#if SHADOW_LAYERS > 0
bool has_shadow(int i) {
    return u_lights[i].direction.w >= 0.0;
}

float seen_by_light(int i, CurvePoint at, vec3 l) {
    bool is_point = i >= DIRECTIONAL_COUNT && i < DIRECTIONAL_COUNT + POINT_COUNT;
    vec3 outside = at.position + 2.0 * at.radius * l; // a fibre does not shadow itself
    return shadow_visibility(int(u_lights[i].direction.w), is_point, outside, l, l, u_lights[i].position.xyz);
}
#endif
#endif

void write_curve(vec3 radiance, CurvePoint at) {
#if MEDIA
    radiance = seen_in_media(radiance, at.position);
#endif
#if HALF_TARGET
    radiance = min(radiance, vec3(65504.0));
#endif
    o_color = vec4(radiance, 1.0);
}
