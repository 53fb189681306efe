// The uniform cubic B-spline through the texels of a map (de Boor 1972). Where a texel covers many pixels, bilinear
// interpolation shows it as a diamond. The B-spline is smooth, and positive: no dark rim surrounds a bright window.
//
// The map is a buffer of pairs of texels (viewer/gpu/smooth_map.py): Mesa's software rasteriser reads eight of them in
// two thirds of the time of the four bilinear lookups that give the same (Sigg and Hadwiger 2005, GPU Gems 2, chapter
// 20). EXACT_TEXELS: it is a buffer of texels in float32, for paths.
#ifndef EXACT_TEXELS
#define EXACT_TEXELS 0
#endif
#if EXACT_TEXELS
#define MAP_BUFFER samplerBuffer

// The sum of four texels of a row with these weights
vec3 row_sum(samplerBuffer texels, int first, vec4 weights) {
    return weights.x * texelFetch(texels, first).rgb + weights.y * texelFetch(texels, first + 1).rgb
        + weights.z * texelFetch(texels, first + 2).rgb + weights.w * texelFetch(texels, first + 3).rgb;
}
#else
#define MAP_BUFFER usamplerBuffer

// A channel of a texel and of its right neighbour, in the map's unit
vec2 texel_pair(uint pair) {
    return uintBitsToFloat(uvec2(pair << 13 & 0x1FFFE000u, pair >> 3 & 0x1FFFE000u));
}

// The sum of four texels of a row with these weights
vec3 row_sum(usamplerBuffer pairs, int first, vec4 weights) {
    uvec4 left = texelFetch(pairs, first), right = texelFetch(pairs, first + 2);
    return vec3(dot(vec4(texel_pair(left.x), texel_pair(right.x)), weights),
                dot(vec4(texel_pair(left.y), texel_pair(right.y)), weights),
                dot(vec4(texel_pair(left.z), texel_pair(right.z)), weights));
}
#endif

// shape: the map's width, height and unit
vec3 bspline(MAP_BUFFER map, vec3 shape, vec2 uv) {
    vec2 position = uv * shape.xy - 0.5;
    vec2 first = floor(position), t = position - first, s = 1.0 - t;
    vec2 w0 = s * s * s * (1.0 / 6.0), w3 = t * t * t * (1.0 / 6.0);
    vec2 w1 = 2.0 / 3.0 - 0.5 * t * t * (2.0 - t), w2 = 2.0 / 3.0 - 0.5 * s * s * (2.0 - s);
    vec4 along = vec4(w0.x, w1.x, w2.x, w3.x);
    int row = int(shape.x) + 3 + EXACT_TEXELS;
    int at = (int(first.y) + 1) * row + int(first.x) + 1; // the first texel is that of row -2 and column -2
    vec3 sum = w0.y * row_sum(map, at, along) + w1.y * row_sum(map, at + row, along)
        + w2.y * row_sum(map, at + 2 * row, along) + w3.y * row_sum(map, at + 3 * row, along);
    return sum * shape.z;
}
