// Averages the variance over neighbouring pixels. The estimate of one pixel with few samples is 0 where all of them
// missed the light (Schied et al. 2017, section 4.2). With fewer than eight samples the variance among the neighbours
// is taken where it is larger.
#include "sample/luminance.glsl"

uniform sampler2D u_light;
uniform sampler2D u_guide;
uniform sampler2D u_sum;
layout(location = 0) out vec4 o_light;

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy), last = textureSize(u_light, 0) - 1;
    float weight = 0.0, variance = 0.0, sum = 0.0, squares = 0.0;
    for (int y = -1; y <= 1; ++y) for (int x = -1; x <= 1; ++x) {
        ivec2 q = clamp(p + ivec2(x, y), ivec2(0), last);
        if (texelFetch(u_guide, q, 0).x < 0.0) continue;
        vec4 light = texelFetch(u_light, q, 0);
        float w = float((2 - abs(x)) * (2 - abs(y))), l = min(luminance(light.rgb), 1e15);
        weight += w;
        variance += w * light.w;
        sum += w * l;
        squares += w * l * l;
    }
    o_light = texelFetch(u_light, p, 0);
    if (weight == 0.0) return;
    o_light.w = variance / weight;
    float spread = squares / weight - (sum / weight) * (sum / weight);
    if (texelFetch(u_sum, p, 0).w < 8.0) o_light.w = max(o_light.w, spread);
}
