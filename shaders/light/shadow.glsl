// Shadow maps in one atlas: one tile for a directional or spot light, six (the faces of a cube) for a point light.
// SHADOW_PATTERN: blended surfaces cast shadows.
struct ShadowTile {
    mat4 matrix;  // eye-relative position to (u, v, depth, 1) * w within the tile
    vec4 texel;   // x + y * distance: the size of a texel in eye-relative units; zw: the tile's corner in atlas texels
};
layout(std140) uniform Shadows {
    ShadowTile u_shadow_tiles[SHADOW_LAYERS];
};
uniform sampler2DShadow u_shadow_map;
uniform float u_shadow_tile_size; // in texels

int cube_face(vec3 d) {
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z) return d.x > 0.0 ? 0 : 1;
    if (a.y >= a.z) return d.y > 0.0 ? 2 : 3;
    return d.z > 0.0 ? 4 : 5;
}

// 3 x 3 tent filter from four bilinear comparisons (Castano 2013, "Shadow Mapping Summary"); texel in atlas texels. The
// level is given, since there are no derivatives where a light is skipped.
float filtered_shadow(vec2 texel, float depth) {
    vec2 size = vec2(textureSize(u_shadow_map, 0));
    vec2 base = floor(texel + 0.5);
    vec2 st = texel + 0.5 - base;
    base -= 0.5;
    vec2 w0 = 3.0 - 2.0 * st, w1 = 1.0 + 2.0 * st;
    vec2 o0 = base + (2.0 - st) / w0 - 1.0, o1 = base + st / w1 + 1.0;
    float sum = w0.x * w0.y * textureLod(u_shadow_map, vec3(vec2(o0.x, o0.y) / size, depth), 0.0);
    sum += w1.x * w0.y * textureLod(u_shadow_map, vec3(vec2(o1.x, o0.y) / size, depth), 0.0);
    sum += w0.x * w1.y * textureLod(u_shadow_map, vec3(vec2(o0.x, o1.y) / size, depth), 0.0);
    sum += w1.x * w1.y * textureLod(u_shadow_map, vec3(vec2(o1.x, o1.y) / size, depth), 0.0);
    return sum / 16.0;
}

#if SHADOW_PATTERN
// What repeats every four texels (raster/shadow.frag) leaves no pattern here: in one axis the filter above weighs
// texels by (1 - s, 2 - s, 1 + s, s) / 4, and the sum of two such filters that lie two texels apart weighs each of four
// residues alike.
const float REACH = 2.5;

float smoothed_shadow(vec2 texel, float depth) {
    float sum = 0.0;
    for (int k = 0; k < 4; ++k) sum += filtered_shadow(texel + vec2(k & 1, k >> 1) * 2.0 - 1.0, depth);
    return 0.25 * sum;
}
#else
const float REACH = 1.5;
#define smoothed_shadow filtered_shadow
#endif

// The fraction of the light that arrives at p; n is the geometric normal, l the direction to the light. To avoid
// self-shadowing, p is moved off its surface by the filter's footprint, and farther at grazing angles, so no bias
// depends on the scale of the scene.
float shadow_visibility(int first_layer, bool is_point, vec3 p, vec3 n, vec3 l, vec3 light_position) {
    vec3 from_light = p - light_position;
    ShadowTile tile = u_shadow_tiles[first_layer + (is_point ? cube_face(from_light) : 0)];
    float footprint = tile.texel.x + tile.texel.y * length(from_light);
    float NoL = clamp(dot(n, l), 0.0, 1.0);
    vec3 offset = n * (footprint * (REACH + 0.5) * sqrt(1.0 - NoL * NoL)) + l * (footprint * 0.5);
    vec4 q = tile.matrix * vec4(p + offset, 1.0);
    if (q.w <= 0.0) return 1.0;
    vec3 c = q.xyz / q.w;
    if (c.z >= 1.0 || min(c.x, c.y) < 0.0 || max(c.x, c.y) > 1.0) return 1.0; // nothing between here and the light
    // The filter reaches so many texels to each side and must not reach the neighbouring tile.
    vec2 texel = clamp(c.xy * u_shadow_tile_size, REACH, u_shadow_tile_size - REACH);
    return smoothed_shadow(tile.texel.zw + texel, c.z);
}

#if MEDIA
// The same at a point of a medium, which has no side that could shadow itself: one comparison of four texels. What lies
// behind everything in a tile is in its shadow, too.
float shadow_in_medium(int first_layer, bool is_point, vec3 p, vec3 light_position) {
    ShadowTile tile = u_shadow_tiles[first_layer + (is_point ? cube_face(p - light_position) : 0)];
    vec4 q = tile.matrix * vec4(p, 1.0);
    if (q.w <= 0.0) return 1.0;
    vec3 c = q.xyz / q.w;
    if (min(c.x, c.y) < 0.0 || max(c.x, c.y) > 1.0) return 1.0;
    vec2 texel = tile.texel.zw + clamp(c.xy * u_shadow_tile_size, 0.5, u_shadow_tile_size - 0.5);
    return textureLod(u_shadow_map, vec3(texel / vec2(textureSize(u_shadow_map, 0)), min(c.z, 1.0)), 0.0);
}
#endif
