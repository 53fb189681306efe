// The shadow of the model on the ground below it: black, with alpha
//   1 - (light that arrives) / (light without the model),
// by the lights' shadow maps and, with HAS_ENVIRONMENT, by the map of what is hidden of the environment's light.
// The ground lies below all that casts shadows, so what a light's map holds at a point is always before it.
#include "sample/luminance.glsl"
#if LIGHT_COUNT > 0
#include "light/punctual.glsl"
#endif
#if SHADOW_LAYERS > 0
#include "light/shadow.glsl"
#endif
#if HAS_ENVIRONMENT
#include "raster/ground_map.glsl"
#endif

uniform float u_height;      // of the ground, eye-relative
uniform vec3 u_below;        // the point of the ground below the model's centre
#if HAS_ENVIRONMENT
uniform float u_far_light;   // luminance of the irradiance of the ground by the environment
uniform sampler2D u_hidden;  // the part of it that the model hides
#endif

noperspective in vec3 v_ray, v_ray_origin; // eye-relative
layout(location = 0) out vec4 o_color;

#if SHADOW_LAYERS > 0
float seen_by_light(int layer, bool is_point, vec3 p, vec3 light_position) {
    ShadowTile tile = u_shadow_tiles[layer + (is_point ? cube_face(p - light_position) : 0)];
    vec4 q = tile.matrix * vec4(p, 1.0);
    vec2 c = q.xy / q.w;
    if (q.w <= 0.0 || min(c.x, c.y) < 0.0 || max(c.x, c.y) > 1.0) return 1.0;
    vec2 texel = clamp(c * u_shadow_tile_size, REACH, u_shadow_tile_size - REACH);
    return smoothed_shadow(tile.texel.zw + texel, 1.0);
}
#endif

void main() {
    float way = (u_height - v_ray_origin.y) / v_ray.y;
    vec3 p = v_ray_origin + way * v_ray;
    bool is_seen = v_ray.y < 0.0 && way > 0.0;
    float all = 0.0, arrives = 0.0;
#if LIGHT_COUNT > 0
    for (int i = 0; i < LIGHT_COUNT; ++i) {
        vec3 l, irradiance = punctual_irradiance(i, p, l);
        float light = luminance(irradiance) * max(l.y, 0.0);
        all += light;
#if SHADOW_LAYERS > 0
        int layer = int(u_lights[i].direction.w);
        bool is_point = i >= DIRECTIONAL_COUNT && i < DIRECTIONAL_COUNT + POINT_COUNT;
        if (layer >= 0 && light > 0.0) light *= seen_by_light(layer, is_point, p, u_lights[i].position.xyz);
#endif
        arrives += light;
    }
#endif
#if HAS_ENVIRONMENT
    vec3 q = p - u_below;
    vec2 s = vec2(to_map(q.x), to_map(q.z));
    all += u_far_light;
    arrives += u_far_light * (1.0 - textureLod(u_hidden, 0.5 + 0.5 * s, 0.0).r);
#endif
    o_color = vec4(0.0, 0.0, 0.0, is_seen && all > 0.0 ? clamp(1.0 - arrives / all, 0.0, 1.0) : 0.0);
}
