// Light that is scattered many times in a deep layer of fibres, which send it mostly onwards: the reflection of a half
// space by Hapke 1981, "Bidirectional Reflectance Spectroscopy", eqs. 8 to 10, and that of a thick layer by asymptotic
// theory (van de Hulst 1980, "Multiple Light Scattering"; Kokhanovsky 2006, "Cloud Optics", sect. 3.2). With mu the
// cosines, c the albedo of a half space seen along its normal, and gamma = sqrt(1 - w) = (1 - c) / (1 + 5/2 c),
//   half space:  pi f = w/4 (H(mu) H(mu') - sin sin' cos(phi - phi')) / (mu + mu'),
//                H(mu) = (1 + 2 mu) / (1 + 2 gamma mu)
//   layer:       pi f = half space - c x T K(mu) K(mu'),   through it   pi f = T K(mu) K(mu'),   K(mu) = 3/7 (1 + 2 mu)
//                T K(1) = w (1 - c^2) x / (1 - c^2 x^2),   x = exp(-7/2 gamma (1 / (t K(1)) - 1))
// where t is the share that white fibres let through: then T = t. The factor w leaves out of T what is not scattered.
// The second term in the half space is light that fibres have scattered once, by a phase function 1 + cos: as much
// forward as leaves f above 0. All this is reciprocal. So that white fibres lose and gain nothing, the half space is
// scaled by DEPTH_SCALE, and what its albedo then lacks for white fibres, d(mu), is added as c d(mu) d(mu') /
// DEPTH_MEAN.
#include "bsdf/constants.glsl"

const float DEPTH_SCALE = 0.9617967; // 1 / (1.5 ln 2): that of white fibres seen along the normal is its largest albedo
const float DEPTH_MEAN = 0.0251190;  // of d over the hemisphere, by the cosine
const float DEPTH_K1 = 9.0 / 7.0;    // K(1)
const float DEPTH_MOST = 0.6;        // t of the thinnest layer for which asymptotic theory leaves reflection above 0

struct Depth {
    vec3 color;   // c
    vec3 gamma;
    vec3 back;    // c x T, for t up to DEPTH_MOST; less what lies below sends back
    vec3 through; // T
    float thin;   // of t what is beyond DEPTH_MOST, as a share that is let through evenly
    vec3 least;   // what pi f on the side of wo exceeds everywhere, by depth_finish
};

Depth depth_of(vec3 color, float t) {
    Depth d;
    d.color = color;
    d.gamma = (1.0 - color) / (1.0 + 2.5 * color); // within 0.005 of c
    float some = clamp(t, 1e-4, DEPTH_MOST);
    vec3 x = exp(max(-3.5 * d.gamma * (1.0 / (some * DEPTH_K1) - 1.0), -80.0));
    vec3 c2 = color * color, omega = 1.0 - d.gamma * d.gamma;
    d.through = omega * (1.0 - c2) * x / max((1.0 - c2 * x * x) * DEPTH_K1, 1e-6);
    d.through = mix(d.through, vec3(some), lessThan(d.gamma, vec3(1e-4)));
    d.back = color * x * d.through;
    d.thin = max(t - some, 0.0) / (1.0 - some);
    if (t < 1e-4) d.through = d.back = vec3(0.0);
    return d;
}

// One layer over another: light goes between them, to and fro.
void depth_lay_over(inout Depth d, Depth below) {
    vec3 own = (1.0 - d.gamma) / (1.0 + d.gamma) - d.back;
    vec3 other = (1.0 - below.thin) * ((1.0 - below.gamma) / (1.0 + below.gamma) - below.back);
    vec3 arriving = d.through / max(1.0 - own * other, 1e-6);
    d.back -= d.through * arriving * other;
    d.through = arriving * mix(below.through, vec3(1.0), below.thin);
}

void depth_finish(inout Depth d) {
    vec3 omega = 1.0 - d.gamma * d.gamma;
    // H(mu) >= 1 + 2 mu (1 - gamma) / (1 + 2 gamma), hence H H' - sin sin' >= 2 (1 - gamma) / (1 + 2 gamma) (mu + mu')
    d.least = (1.0 - d.thin) * max(DEPTH_SCALE * 0.5 * omega * (1.0 - d.gamma) / (1.0 + 2.0 * d.gamma)
                                   - max(d.back, 0.0) * DEPTH_K1 * DEPTH_K1, 0.0);
}

float depth_k(float mu) {
    return 3.0 / 7.0 * (1.0 + 2.0 * mu);
}

vec3 depth_h(Depth d, float mu) {
    return (1.0 + 2.0 * mu) / (1.0 + 2.0 * d.gamma * mu);
}

// The albedo of the half space of white fibres: (1 + 2 mu) / 2 int_0^1 (1 + 2 m) m / (m + mu) dm
float depth_white(float mu) {
    return (0.5 + mu) * (2.0 - 2.0 * mu - mu * (1.0 - 2.0 * mu) * log((1.0 + mu) / max(mu, 1e-6)));
}

// pi f of directions on the same side
vec3 depth_back(Depth d, vec3 wo, vec3 wi) {
    float o = abs(wo.z), i = abs(wi.z);
    float onwards = -dot(wo.xy, wi.xy);
    vec3 omega = 1.0 - d.gamma * d.gamma;
    vec3 half_space = omega * (0.25 * DEPTH_SCALE / max(o + i, 1e-6)) * (depth_h(d, o) * depth_h(d, i) + onwards);
    float lacking = (1.0 - DEPTH_SCALE * depth_white(o)) * (1.0 - DEPTH_SCALE * depth_white(i)) / DEPTH_MEAN;
    vec3 all = half_space + d.color * lacking - d.back * (depth_k(o) * depth_k(i));
    return (1.0 - d.thin) * max(all, 0.0);
}

// pi f of directions on either side
vec3 depth_through(Depth d, vec3 wo, vec3 wi) {
    return mix(d.through * (depth_k(abs(wo.z)) * depth_k(abs(wi.z))), d.color, d.thin);
}

// The shares of light that leave on its side and on the other one, as seen along the normal; through it, from all
// around
vec3 depth_mean_back(Depth d) {
    return (1.0 - d.thin) * max(d.color - d.back, 0.0);
}

vec3 depth_mean_through(Depth d) {
    return mix(d.through, d.color, d.thin);
}

// The share that leaves on the side of wo and on the other one. The integral int_0^1 H(m) m / (m + mu) dm by four
// Gauss-Legendre nodes, with the same error for white fibres, for which it is known.
void depth_albedo(Depth d, float mu, out vec3 back, out vec3 through) {
    const vec4 node = vec4(0.0694318, 0.3300095, 0.6699905, 0.9305682);
    const vec4 weight = vec4(0.1739274, 0.3260726, 0.3260726, 0.1739274);
    vec3 sum = vec3(0.0);
    float white = 0.0;
    for (int k = 0; k < 4; ++k) {
        float part = weight[k] * node[k] / (node[k] + mu);
        sum += part * depth_h(d, node[k]);
        white += part * (1.0 + 2.0 * node[k]);
    }
    vec3 omega = 1.0 - d.gamma * d.gamma;
    vec3 half_space = omega * depth_h(d, mu) * sum / ((1.0 + 2.0 * mu) * white) * depth_white(mu);
    back = DEPTH_SCALE * half_space + d.color * (1.0 - DEPTH_SCALE * depth_white(mu)) - d.back * depth_k(mu);
    back = (1.0 - d.thin) * max(back, 0.0);
    through = mix(d.through * depth_k(mu), d.color, d.thin);
}
