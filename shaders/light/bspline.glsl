// The uniform cubic B-spline through the texels of a map: four bilinear look-ups, each between two texels at the ratio
// of their weights (Sigg and Hadwiger 2005, GPU Gems 2, chapter 20). Where a texel covers many pixels, bilinear
// interpolation shows it as a diamond. The B-spline is smooth, and positive: no dark rim surrounds a bright window.
vec3 bspline(sampler2D map, vec2 uv) {
    vec2 size = vec2(textureSize(map, 0));
    vec2 position = uv * size - 0.5;
    vec2 first = floor(position), t = position - first, s = 1.0 - t;
    vec2 w0 = s * s * s * (1.0 / 6.0), w3 = t * t * t * (1.0 / 6.0);
    vec2 w1 = 2.0 / 3.0 - 0.5 * t * t * (2.0 - t), w2 = 2.0 / 3.0 - 0.5 * s * s * (2.0 - s);
    vec2 texel = 1.0 / size;
    vec2 left = (first - 0.5 + w1 / (w0 + w1)) * texel;
    vec2 right = (first + 1.5 + w3 / (w2 + w3)) * texel;
    vec2 share = w2 + w3;
    vec3 below = mix(textureLod(map, left, 0.0).rgb, textureLod(map, vec2(right.x, left.y), 0.0).rgb, share.x);
    vec3 above = mix(textureLod(map, vec2(left.x, right.y), 0.0).rgb, textureLod(map, right, 0.0).rgb, share.x);
    return mix(below, above, share.y);
}
