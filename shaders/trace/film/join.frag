// The sums of a pixel's n samples with the light of N photons among them: a mean and a variance that are the sums of
// both.
//   mean = sum / n + s,   s = splats / N,   variance of s = (squares of splats / N - s^2) / N
//   squares = n (mean^2 + (n - 1) (variance of the samples' mean + variance of s))
uniform sampler2D u_sum, u_squares, u_photon_sum, u_photon_squares;
uniform float u_photons; // N

layout(location = 0) out vec4 o_sum;
layout(location = 1) out vec4 o_squares;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = texelFetch(u_sum, pixel, 0), squares = texelFetch(u_squares, pixel, 0);
    float n = max(sum.a, 1.0), count = max(u_photons, 1.0);
    vec3 own = sum.rgb / n, brought = texelFetch(u_photon_sum, pixel, 0).rgb / count;
    vec3 brought_variance = max(texelFetch(u_photon_squares, pixel, 0).rgb / count - brought * brought, 0.0) / count;
    vec3 mean = own + brought;
    // own variance times n - 1
    vec3 spread = max(squares.rgb / n - own * own, 0.0) + (n - 1.0) * brought_variance;
    o_sum = sum.a > 0.0 ? vec4(mean * n, sum.a) : sum;
    o_squares = sum.a > 0.0 ? vec4(n * (mean * mean + spread), squares.a) : squares;
}
