// The mean radiance of the film, with associated alpha.
uniform sampler2D u_sum;     // rgb, samples
uniform sampler2D u_squares; // of rgb; alpha

out vec4 o_radiance;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = texelFetch(u_sum, pixel, 0);
    o_radiance = vec4(sum.rgb, texelFetch(u_squares, pixel, 0).a) / max(sum.a, 1.0);
}
