// Shades curves as fibres under lights and an environment.
in vec3 v_position;
in vec3 v_along;
in float v_across;
in float v_pixels;
in float v_radius;
#if HAS_COLORS
in vec3 v_sigma_a;
#else
uniform vec3 u_sigma_a;
#endif
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif
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
#include "raster/curve_light.glsl"

uniform vec4 u_fibre; // beta_m, beta_n, tilt, index of refraction
#if IS_ORTHOGRAPHIC
uniform vec3 u_view_direction; // towards the eye
#endif

layout(location = 0) out vec4 o_color;

#if LIGHT_COUNT > 0
vec3 light_on_fibre(int i, SeenFibre s, mat3 frame) {
    vec3 l;
    vec3 irradiance = punctual_irradiance(i, v_position, l);
#if MEDIA
    irradiance *= transmittance_to_light(i, v_position, l);
#endif
#if SHADOW_LAYERS > 0
    float layer = u_lights[i].direction.w;
    if (layer >= 0.0) {
        bool is_point = i >= DIRECTIONAL_COUNT && i < DIRECTIONAL_COUNT + POINT_COUNT;
        vec3 outside = v_position + 2.0 * v_radius * l; // a fibre does not shadow itself
        float seen = shadow_visibility(int(layer), is_point, outside, l, l, u_lights[i].position.xyz);
#if HAIR_LIGHT
        seen += (1.0 - seen) * light_through_fibres(i, v_position);
#endif
        irradiance *= seen;
    }
#endif
    return fibre_response(s, l * frame) * irradiance;
}
#endif

void main() {
    vec3 along = normalize(v_along);
#if IS_ORTHOGRAPHIC
    vec3 v = u_view_direction;
#else
    vec3 v = -normalize(v_position);
#endif
    vec3 front = v - along * dot(v, along);
    float cosine = length(front);
    front = cosine > 1e-4 ? front / cosine : normalize(cross(along, vec3(along.y, along.z, -along.x)));
    mat3 frame = mat3(along, cross(front, along), front);
    vec3 sigma_a =
#if HAS_COLORS
        v_sigma_a;
#else
        u_sigma_a;
#endif
    Fibre f = Fibre(sigma_a, u_fibre.x, u_fibre.y, u_fibre.z, u_fibre.w);
    SeenFibre s = seen_fibre(f, vec3(dot(v, along), 0.0, cosine), clamp(v_across, -1.0, 1.0), v_pixels);

    vec3 radiance = vec3(0.0);
#if HAS_ENVIRONMENT || HAIR_LIGHT
    vec3 around = light_about_fibre(s, frame, v_position);
#if MEDIA
    MediaLight media = light_around(v_position, vec3(0.0));
    around = around * media.sky + media.scattered;
#endif
    radiance += around;
#endif
#if LIGHT_COUNT > 0
    for (int i = 0; i < LIGHT_COUNT; ++i) radiance += light_on_fibre(i, s, frame);
#endif
#if MEDIA
    radiance = seen_in_media(radiance, v_position);
#endif
#if HALF_TARGET
    radiance = min(radiance, vec3(65504.0));
#endif
    o_color = vec4(radiance, 1.0);
}
