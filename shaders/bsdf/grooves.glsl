// A lobe over all the normals that a texel of a mip level is the mean m of, as normal_spread.glsl has it, but stretched
// as the square root of their covariance C says, of which there is another texel (viewer/scene/normal_spread.py). The
// columns of `map` are the map's axes. J takes x and y of unit normals to slopes about the mean normal, along the first
// two axes of the lobe's frame; alpha^2 is a matrix there, which gains (1.17)^2 J C J^T: so that the median slope of
// GGX, alpha / sqrt(3), is that of a Gaussian, 0.674 sigma. 2 J C J^T has tails that reach lamps which no texel shows.
// The eigenvectors of the sum are the new axes.
void stretch_lobe(inout vec2 alpha, inout mat3 frame, vec3 texel, vec3 root, float scale, mat3 map) {
    vec3 m = texel * (255.0 / 127.5) - 1.0;
    vec2 slope = m.xy / max(m.z, 1e-2);
    mat2 to_slopes = (mat2(1.0) + outerProduct(slope, slope)) * (scale / max(m.z, 1e-2));
    mat2 to_frame = transpose(mat2x3(frame)) * mat2x3(map) / length(map * vec3(scale * slope, 1.0));
    float xy = root.z - 128.0 / 255.0;
    mat2 g = to_frame * to_slopes * mat2(root.x, xy, xy, root.y);
    mat2 sum = mat2(alpha.x * alpha.x, 0.0, 0.0, alpha.y * alpha.y) + 1.365 * g * transpose(g);
    float mean = 0.5 * (sum[0].x + sum[1].y), half_difference = 0.5 * (sum[0].x - sum[1].y);
    float d = length(vec2(half_difference, sum[0].y)), least = min(alpha.x, alpha.y);
    vec2 axis = half_difference >= 0.0 ? vec2(d + half_difference, sum[0].y) : vec2(sum[0].y, d - half_difference);
    axis = d > 0.0 ? normalize(axis) : vec2(1.0, 0.0);
    alpha = sqrt(clamp(vec2(mean + d, mean - d), least * least, 1.0));
    frame = mat3(axis.x * frame[0] + axis.y * frame[1], axis.x * frame[1] - axis.y * frame[0], frame[2]);
}
