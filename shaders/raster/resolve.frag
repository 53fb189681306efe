// The samples of linear radiance averaged, as a box filter over the pixel does.
uniform sampler2DMS u_samples;
out vec4 o_color;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < SAMPLES; ++k) sum += texelFetch(u_samples, pixel, k);
    o_color = sum / float(SAMPLES);
}
