// How sure a tile of the film is, a pixel for TILE x TILE: sum of the relative variances of its pixels' means, how many
// pixels have one, samples, and how many pixels there are.
//   variance of the mean = (sum of squares - n mean^2) / (n (n - 1)),   relative: over level^2 + 0.01, mean of channels
// where level is the mean less its deviation, but at least the mean of the eight pixels around where that is lower than
// its own: a pixel that is bright by one lucky sample would else vouch for itself, its deviation being its mean.
uniform sampler2D u_sum;     // rgb, samples
uniform sampler2D u_squares;

out vec4 o_tile;

vec3 mean_around(ivec2 pixel, vec4 own, ivec2 last) {
    vec4 sum = -own;
    for (int k = 0; k < 9; ++k) {
        ivec2 at = pixel + ivec2(k % 3, k / 3) - 1;
        if (at == clamp(at, ivec2(0), last)) sum += texelFetch(u_sum, at, 0);
    }
    return sum.a > 0.0 ? sum.rgb / sum.a : own.rgb / own.a; // alone in the picture
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
