// The surface that a light meets first, by its shadow map.
uniform sampler2D u_depths; // the atlas of u_shadow_map

struct LitSurface {
    vec3 place;
    vec3 normal; // towards the light; 0 where it meets nothing
};

struct Tile {
    mat4 to_place; // from (u, v, depth)
    ivec2 corner;
};

const int STEP = 4; // texels between the depths of which the normal is found

Tile tile_of(int layer) {
    return Tile(inverse(u_shadow_tiles[layer].matrix), ivec2(u_shadow_tiles[layer].texel.zw));
}

vec3 place_at(Tile tile, vec2 texel, float depth) {
    vec4 q = tile.to_place * vec4(texel / u_shadow_tile_size, depth, 1.0);
    return q.xyz / q.w;
}

float depth_at(Tile tile, vec2 texel) {
    ivec2 inside = clamp(ivec2(texel), ivec2(0), ivec2(u_shadow_tile_size) - 1);
    return texelFetch(u_depths, tile.corner + inside, 0).r;
}

// The way over the surface along an axis of the tile, to the side on which it is more likely to go on
vec3 along_surface(Tile tile, vec2 texel, float depth, vec2 axis) {
    vec2 there = texel + float(STEP) * axis, back = texel - float(STEP) * axis;
    float after = depth_at(tile, there), before = depth_at(tile, back);
    vec3 place = place_at(tile, texel, depth);
    if (abs(after - depth) < abs(before - depth)) return place_at(tile, there, after) - place;
    return place - place_at(tile, back, before);
}

// At the middle of a texel of a tile, which is that of light i
LitSurface lit_surface(Tile tile, vec2 texel, int i) {
    float depth = depth_at(tile, texel);
    if (depth >= 1.0) return LitSurface(vec3(0.0), vec3(0.0));
    LitSurface s;
    s.place = place_at(tile, texel, depth);
    vec3 n = cross(along_surface(tile, texel, depth, vec2(1.0, 0.0)),
                   along_surface(tile, texel, depth, vec2(0.0, 1.0))), l;
    punctual_irradiance(i, s.place, l);
    s.normal = n * inversesqrt(max(dot(n, n), 1e-30)) * (dot(n, l) < 0.0 ? -1.0 : 1.0);
    return s;
}
