// The part of all light that a light has and the model hides, which blending adds to the ground's map. The ground lies
// below all that casts shadows, so what a tile holds at a point is always before it.
#include "raster/ground_map.glsl"

uniform sampler2DShadow u_atlas;
uniform float u_texel; // the size of a texel of the map

flat in vec3 v_u, v_v;
flat in vec4 v_tile;
flat in float v_part;
out float o_hidden;

void main() {
    vec2 s = gl_FragCoord.xy * u_texel - 1.0;
    vec3 p = vec3(from_map(s.x), from_map(s.y), 1.0);
    vec2 c = vec2(dot(v_u, p), dot(v_v, p));
    bool is_outside = min(c.x, c.y) < 0.0 || max(c.x, c.y) > 1.0;
    float arrives = textureLod(u_atlas, vec3(v_tile.xy + c * v_tile.zw, 1.0), 0.0);
    o_hidden = is_outside ? 0.0 : v_part * (1.0 - arrives);
}
