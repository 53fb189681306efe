// Fast approximate antialiasing of a displayed picture (Lottes 2009, "FXAA"): find the edge through a pixel, how far it
// runs to either side before it steps, and look up the colour as far across the edge as the step's distance says.
uniform sampler2D u_displayed; // associated alpha, bilinear

out vec4 o_color;

const float CONTRAST_ABSOLUTE = 0.04; // below this in the dark, and below
const float CONTRAST_RELATIVE = 0.125; // this share of the local maximum, nobody sees the stairs
const float SUBPIXEL = 0.5;            // how much of a lone pixel is spread; more would blur textures

// What the eye sees as an edge: a step in luma or in coverage.
float luma(vec4 c) {
    return dot(c.rgb, vec3(0.299, 0.587, 0.114)) + c.a;
}

float luma_at(ivec2 pixel) {
    return luma(texelFetch(u_displayed, clamp(pixel, ivec2(0), textureSize(u_displayed, 0) - 1), 0));
}

// Distance from uv along `along` to where the edge's mean luma has changed by `limit`, and by how much it has.
vec2 walk(vec2 uv, vec2 along, float mean, float limit) {
    float travelled = 0.0, change = 0.0;
    float stride = 1.0;
    for (int i = 0; i < 7; ++i) {
        travelled += stride;
        change = luma(textureLod(u_displayed, uv + along * travelled, 0.0)) - mean;
        if (abs(change) >= limit) break;
        stride = i < 4 ? 1.0 : stride * 1.5;
    }
    return vec2(travelled, change);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 here = texelFetch(u_displayed, pixel, 0);
    float m = luma(here);
    float n = luma_at(pixel + ivec2(0, 1)), s = luma_at(pixel - ivec2(0, 1));
    float e = luma_at(pixel + ivec2(1, 0)), w = luma_at(pixel - ivec2(1, 0));
    float high = max(m, max(max(n, s), max(e, w))), low = min(m, min(min(n, s), min(e, w)));
    float range = high - low;
    if (range >= max(CONTRAST_ABSOLUTE, (high - here.a) * CONTRAST_RELATIVE)) {
        vec2 px = 1.0 / vec2(textureSize(u_displayed, 0));
        vec2 uv = gl_FragCoord.xy * px;
        float ne = luma_at(pixel + ivec2(1, 1)), nw = luma_at(pixel + ivec2(-1, 1));
        float se = luma_at(pixel + ivec2(1, -1)), sw = luma_at(pixel - ivec2(1, 1));
        float across_y = 2.0 * abs(n + s - 2.0 * m) + abs(ne + se - 2.0 * e) + abs(nw + sw - 2.0 * w);
        float across_x = 2.0 * abs(e + w - 2.0 * m) + abs(ne + nw - 2.0 * n) + abs(se + sw - 2.0 * s);
        bool horizontal = across_y >= across_x;

        // The side of the pixel the edge lies on, and a point on it.
        float plus = horizontal ? n : e, minus = horizontal ? s : w;
        vec2 step_across = horizontal ? vec2(0.0, px.y) : vec2(px.x, 0.0);
        vec2 along = horizontal ? vec2(px.x, 0.0) : vec2(0.0, px.y);
        float gradient = abs(plus - m);
        if (abs(minus - m) > gradient) {
            gradient = abs(minus - m);
            step_across = -step_across;
            plus = minus;
        }
        float mean = 0.5 * (m + plus);
        vec2 edge = uv + 0.5 * step_across;
        vec2 forth = walk(edge, along, mean, 0.25 * gradient);
        vec2 back = walk(edge, -along, mean, 0.25 * gradient);
        vec2 nearest = forth.x < back.x ? forth : back;
        // Only where the edge steps away from this pixel's side does part of the pixel belong to the other side.
        bool steps_away = (nearest.y < 0.0) != (m < mean);
        float shift = steps_away && abs(nearest.y) >= 0.25 * gradient ? 0.5 - nearest.x / (forth.x + back.x) : 0.0;

        float around = (2.0 * (n + s + e + w) + ne + nw + se + sw) / 12.0;
        float lone = clamp(abs(around - m) / range, 0.0, 1.0);
        lone = lone * lone * (3.0 - 2.0 * lone);
        shift = max(shift, lone * lone * SUBPIXEL);
        here = textureLod(u_displayed, uv + shift * step_across, 0.0);
    }
    o_color = vec4(here.a > 0.0 ? here.rgb / here.a : vec3(0.0), here.a);
}
