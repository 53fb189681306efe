// Texture maps. Each image is a page of an atlas. A map is read at level 0 with the wrapping of its sampler. The
// bilinear weights are computed here, because a GPU's own filter keeps only 8 bits of them.
#include "trace/scene_buffer.glsl"

const uint WRAP_MASK = (1u << MAP_WRAP_BITS) - 1u;

uniform int u_maps;
#if HAS_COLOR_MAPS
uniform sampler2D u_color_atlas; // light: sRGB that the fetch decodes, or linear halves
#endif
#if HAS_DATA_MAPS
uniform sampler2D u_data_atlas;
#endif

struct TextureMap {
    vec2 corner, size; // of the page, in texels
    uint flags;        // as viewer/trace/layout.py describes them
    vec2 uv;
};

TextureMap texture_map(int index, vec2 uv0, vec2 uv1) {
    int first = u_maps + index * MAP_TEXELS;
    uvec4 record = scene_uint4(first);
    TextureMap map;
    map.corner = vec2(record.x & 0xffffu, record.x >> 16);
    map.size = vec2(record.y & 0xffffu, record.y >> 16);
    map.flags = record.z;
    map.uv = uv0;
#if HAS_UV1
    if ((record.z & uint(MAP_SECOND_UV)) != 0u) map.uv = uv1;
#endif
#if HAS_UV_TRANSFORM
    if ((record.z & uint(MAP_TRANSFORMED)) != 0u) {
        vec3 p = vec3(map.uv, 1.0);
        map.uv = vec2(dot(scene_float4(first + 1).xyz, p), dot(scene_float4(first + 2).xyz, p));
    }
#endif
    return map;
}

bool has_role(TextureMap map, uint role) {
    return (map.flags >> MAP_ROLE_SHIFT & role) != 0u;
}

// The four texels of a bilinear look-up, and the weights of the second column and row
struct Footprint {
    ivec2 low, high;
    vec2 weight;
};

Footprint footprint(TextureMap map) {
    uvec2 wrap = uvec2(map.flags & WRAP_MASK, map.flags >> MAP_WRAP_BITS & WRAP_MASK);
    bvec2 repeats = equal(wrap, uvec2(WRAP_REPEAT));
    vec2 folded = 1.0 - abs(map.uv - 2.0 * floor(0.5 * map.uv) - 1.0);
    vec2 uv = mix(mix(folded, clamp(map.uv, 0.0, 1.0), equal(wrap, uvec2(WRAP_CLAMP))), fract(map.uv), repeats);
    vec2 x = uv * map.size - 0.5;
    if ((map.flags & uint(MAP_NEAREST)) != 0u) x = floor(x + 0.5);
    vec2 low = floor(x);
    vec2 last = map.size - 1.0;
    Footprint f;
    f.weight = x - low;
    vec2 high = low + 1.0;
    // A page of one texel is its own neighbour.
    high = mix(high, mix(last, vec2(0.0), repeats), greaterThan(high, last));
    low = mix(low, mix(vec2(0.0), last, repeats), lessThan(low, vec2(0.0)));
    f.low = ivec2(map.corner + clamp(low, vec2(0.0), last));
    f.high = ivec2(map.corner + clamp(high, vec2(0.0), last));
    return f;
}

vec4 sample_atlas(sampler2D atlas, TextureMap map) {
    Footprint f = footprint(map);
    vec4 upper = mix(texelFetch(atlas, f.low, 0), texelFetch(atlas, ivec2(f.high.x, f.low.y), 0), f.weight.x);
    vec4 lower = mix(texelFetch(atlas, ivec2(f.low.x, f.high.y), 0), texelFetch(atlas, f.high, 0), f.weight.x);
    return mix(upper, lower, f.weight.y);
}
