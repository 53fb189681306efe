// The shadow of the model on the ground below it: black, with alpha
//   1 - (light that arrives) / (light without the model),
// by the lights' shadow maps and those of FAR_LIGHTS directional lights that stand for the environment.
// The ground lies below all that casts shadows, so what a light's map holds at a point is always before it.
#include "sample/luminance.glsl"
#if LIGHT_COUNT > 0
#include "light/punctual.glsl"
#endif
#if SHADOW_LAYERS > 0
#include "light/shadow.glsl"
#endif

uniform float u_height;      // of the ground, eye-relative
uniform vec3 u_below;        // the point of the ground below the model's centre
#if FAR_LIGHTS
struct GroundLight {
    vec4 u, v;      // rows of the matrix from a point relative to u_below to its tile, in (0, 1)
    vec4 tile;      // its corner and its size in the atlas, in texture coordinates
    vec4 luminance; // x: of the irradiance of the ground
};
layout(std140) uniform GroundLights {
    GroundLight u_ground_lights[FAR_LIGHTS];
};
uniform sampler2DShadow u_atlas;
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
#if FAR_LIGHTS
    vec4 q = vec4(p - u_below, 1.0);
    for (int i = is_seen ? 0 : FAR_LIGHTS; i < FAR_LIGHTS; ++i) { // none above the horizon
        GroundLight light = u_ground_lights[i];
        vec2 c = vec2(dot(light.u, q), dot(light.v, q));
        bool is_outside = min(c.x, c.y) < 0.0 || max(c.x, c.y) > 1.0;
        all += light.luminance.x;
        vec3 texel = vec3(light.tile.xy + c * light.tile.zw, 1.0);
        arrives += light.luminance.x * (is_outside ? 1.0 : textureLod(u_atlas, texel, 0.0));
    }
#endif
    o_color = vec4(0.0, 0.0, 0.0, is_seen && all > 0.0 ? clamp(1.0 - arrives / all, 0.0, 1.0) : 0.0);
}
