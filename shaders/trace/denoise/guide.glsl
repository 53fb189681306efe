// The guide tells the wavelet filter which pixels belong together. It is one texel: x packs the first hit into 24 bits,
// or is -1 where nothing was hit; y is the mean depth, NO_DEPTH in a medium; z and w are the depth's slope.

const float NO_DEPTH = 0.0;

struct Guide {
    vec3 normal;    // unit
    float coverage; // share of the samples that hit something
    float albedo;   // its luminance
};

const float NORMAL_STEPS = 127.0; // an octahedral map (Meyer et al. 2010) in 7 bits each: one degree
const float SHARE_STEPS = 31.0;

float pack_guide(Guide g) {
    vec3 n = g.normal / (abs(g.normal.x) + abs(g.normal.y) + abs(g.normal.z));
    if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
    vec4 bits = vec4((0.5 + 0.5 * n.xy) * NORMAL_STEPS, vec2(g.coverage, g.albedo) * SHARE_STEPS);
    return dot(floor(bits + 0.5), vec4(1.0, 128.0, 16384.0, 524288.0));
}

Guide unpack_guide(float bits) {
    vec4 high = floor(bits / vec4(1.0, 128.0, 16384.0, 524288.0));
    vec4 part = high - vec4(high.yzw * vec3(128.0, 128.0, 32.0), 0.0);
    vec2 p = part.xy / (0.5 * NORMAL_STEPS) - 1.0;
    float z = 1.0 - abs(p.x) - abs(p.y);
    p -= sign(p) * max(-z, 0.0);
    return Guide(normalize(vec3(p, z)), part.z / SHARE_STEPS, part.w / SHARE_STEPS);
}
