// The sums of so many samples of a pixel that no triangle can touch, as trace/finish.frag adds them up.
#include "trace/is_finite.glsl"

layout(location = 0) out vec4 o_sum;     // rgb, 1
layout(location = 1) out vec4 o_squares; // of rgb; alpha

// `sky` is a texel of viewer/trace/paths/sky.py
void write_sky(vec4 sky, int samples) {
    float count = sky.a == 1.0 && is_finite(sky.rgb) ? float(samples) : 0.0;
    vec3 radiance = count > 0.0 ? sky.rgb : vec3(0.0);
    o_sum = count * vec4(radiance, 1.0);
    o_squares = count * vec4(radiance * radiance, BACKGROUND > 0 ? 1.0 : 0.0);
}
