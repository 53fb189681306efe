// Estimates the error of the film, one pixel for each tile of TILE x TILE: the sum of the relative variances of the
// pixels' means, the number of pixels that have one, the number of samples, and the number of pixels.
//   variance of the mean = (sum of squares - n mean^2) / (n (n - 1)),   relative: over level^2 + 0.01, mean of channels
// where level is the mean minus its standard deviation, but at least the smaller of the mean and the mean of the eight
// neighbours. A pixel that is bright by one lucky sample has a standard deviation as large as its mean. Divided by its
// own mean, its variance would seem small.
uniform sampler2D u_sum;     // rgb, samples
uniform sampler2D u_squares;

out vec4 o_tile;

vec3 mean_around(ivec2 pixel, vec4 own, ivec2 last) {
    vec4 sum = -own;
    for (int k = 0; k < 9; ++k) {
        ivec2 neighbour = pixel + ivec2(k % 3, k / 3) - 1;
        if (neighbour == clamp(neighbour, ivec2(0), last)) sum += texelFetch(u_sum, neighbour, 0);
    }
    return sum.a > 0.0 ? sum.rgb / sum.a : own.rgb / own.a; // a picture of one pixel
}

void main() {
    ivec2 size = textureSize(u_sum, 0);
    ivec2 low = ivec2(gl_FragCoord.xy) * TILE, high = min(low + TILE, size);
    vec4 tile = vec4(0.0);
    for (int y = low.y; y < high.y; ++y) {
        for (int x = low.x; x < high.x; ++x) {
            vec4 sum = texelFetch(u_sum, ivec2(x, y), 0);
            float n = sum.a;
            tile.zw += vec2(n, 1.0);
            if (n < 2.0) continue;
            vec3 mean = sum.rgb / n;
            vec3 variance = max(texelFetch(u_squares, ivec2(x, y), 0).rgb / n - mean * mean, 0.0) / (n - 1.0);
            vec3 level = max(min(mean, mean_around(ivec2(x, y), sum, size - 1)), mean - sqrt(variance));
            tile.xy += vec2(dot(variance / (level * level + 0.01), vec3(1.0 / 3.0)), 1.0);
        }
    }
    o_tile = tile;
}
