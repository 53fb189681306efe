// Averages the samples of a pixel, in linear radiance: a box filter.
#if SAMPLES > 1
uniform sampler2DMS u_samples;
#else
uniform sampler2D u_samples;
#endif
out vec4 o_color;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * SUPERSAMPLING;
    vec4 sum = vec4(0.0);
    for (int y = 0; y < SUPERSAMPLING; ++y) {
        for (int x = 0; x < SUPERSAMPLING; ++x) {
            for (int k = 0; k < SAMPLES; ++k) sum += texelFetch(u_samples, corner + ivec2(x, y), SAMPLES > 1 ? k : 0);
        }
    }
    o_color = sum / float(SAMPLES * SUPERSAMPLING * SUPERSAMPLING);
}
