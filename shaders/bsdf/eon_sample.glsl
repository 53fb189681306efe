// Samples the cosine-weighted lobe of EON: with the probability P a uniform direction, else one of a cosine lobe that
// the matrix M shapes for the viewer's direction, clipped at the horizon (CLTC).
//   M = (a 0 b; 0 c 0; d 0 1) in the frame whose x axis is below wo,   density = cos / (pi S) |M^-1 wi|^-3 / det M
// S is the part of the cosine lobe's disk that M leaves above the horizon: (1 + 1 / sqrt(1 + d^2)) / 2.
// Portsmouth, Kutz & Hill 2024, section 4, with their fits of P, a, b, c and d. f cos / density is at most 1.5, where
// a cosine lobe has 78 towards grazing angles.
#include "sample/hemisphere.glsl"

struct Cltc {
    float a, b, c, d;
    float area;          // S
    float p_uniform;
    vec2 x;              // the direction of the x axis
};

Cltc cltc_of(vec3 wo, float sigma) {
    Cltc m;
    float mu = wo.z, r = sigma;
    m.a = 1.0 + r * (0.303392 + (-0.518982 + 0.111709 * mu) * mu + (-0.276266 + 0.335918 * mu) * r);
    m.b = r * (-1.16407 + 1.15859 * mu + (0.150815 - 0.150105 * mu) * r) / (mu * mu * mu - 1.43545);
    m.c = 1.0 + (0.20013 + (-0.506373 + 0.261777 * mu) * mu) * r;
    m.d = (0.540852 + (-1.01625 + 0.475392 * mu) * mu) * r / (-1.0743 + mu * (0.0725628 + mu));
    m.area = 0.5 + 0.5 * inversesqrt(1.0 + m.d * m.d);
    m.p_uniform = pow(r, 0.1) * (0.162925 + mu * (-0.372058 + (0.538233 - 0.290822 * mu) * mu));
    float l = length(wo.xy);
    m.x = l > 0.0 ? wo.xy / l : vec2(1.0, 0.0);
    return m;
}

float pdf_eon(vec3 wo, vec3 wi, float sigma) {
    if (sigma == 0.0) return pdf_cosine_hemisphere(wi);
    if (wi.z <= 0.0) return 0.0;
    Cltc m = cltc_of(wo, sigma);
    vec3 w = vec3(dot(m.x, wi.xy), m.x.x * wi.y - m.x.y * wi.x, wi.z);
    float inner = m.a - m.b * m.d, det = m.c * inner;
    vec3 h = vec3(m.c * (w.x - m.b * w.z), inner * w.y, m.c * (m.a * w.z - m.d * w.x)); // det M^-1 w
    float ratio = det / dot(h, h);
    float shaped = ratio * ratio * max(h.z, 0.0) * INV_PI / m.area;
    return mix(shaped, 0.5 * INV_PI, m.p_uniform);
}

vec3 sample_eon(vec3 wo, float sigma, vec2 u) {
    if (sigma == 0.0) return sample_cosine_hemisphere(u);
    Cltc m = cltc_of(wo, sigma);
    vec3 w;
    if (u.x < m.p_uniform) {
        float z = u.x / m.p_uniform, phi = 2.0 * PI * u.y;
        w = vec3(sqrt(max(1.0 - z * z, 0.0)) * vec2(cos(phi), sin(phi)), z);
    } else {
        vec2 p = sample_disk(vec2((u.x - m.p_uniform) / (1.0 - m.p_uniform), u.y));
        p.x = mix(sqrt(max(1.0 - p.y * p.y, 0.0)), p.x, m.area); // the part of the disk above the horizon
        vec3 h = vec3(-p.x, p.y, sqrt(max(1.0 - dot(p, p), 0.0)));
        w = normalize(vec3(m.a * h.x + m.b * h.z, m.c * h.y, m.d * h.x + h.z));
    }
    return vec3(m.x.x * w.x - m.x.y * w.y, m.x.y * w.x + m.x.x * w.y, w.z);
}
