// The bilinear interpolation of a map's texels at texture coordinates in [0, 1], which goes on across the seam in u and
// not over the border in v. A texture unit of a GPU has 8 bits for the place between two texels: an error of 1/512 of
// their difference, beside a sun more than all else in the map.
vec3 bilinear(sampler2D map, vec2 uv) {
    ivec2 size = textureSize(map, 0);
    vec2 position = uv * vec2(size) - 0.5;
    vec2 first = floor(position), t = position - first;
    ivec2 low = ivec2(first), high = low + 1;
    if (low.x < 0) low.x += size.x;
    if (high.x >= size.x) high.x -= size.x;
    low.y = max(low.y, 0);
    high.y = min(high.y, size.y - 1);
    return mix(mix(texelFetch(map, low, 0).rgb, texelFetch(map, ivec2(high.x, low.y), 0).rgb, t.x),
               mix(texelFetch(map, ivec2(low.x, high.y), 0).rgb, texelFetch(map, high, 0).rgb, t.x), t.y);
}
