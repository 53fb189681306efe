// The lobe of a cloth's fibres that includes light scattered several times between them: Zeltner, Burley & Chiang 2022,
// "Practical Multiple-Scattering Sheen Using Linearly Transformed Cosines". With E the directional albedo,
//   f cos = E(mu, r) D(wi),  D = |A| (A wi).z / (pi |A wi|^4),  A = (a 0 b; 0 a 0; 0 0 1)
// in the frame whose x axis is wo's tangent. D integrates to 1 and is sampled exactly, but f is not reciprocal: a and b
// are of wo alone. E, a and b are the fits to the tables of the paper that MaterialX 1.39 has (`zeltner` mode of
// sheen). r is the roughness from 0.01 to 1, where the tables end.
#include "bsdf/constants.glsl"
#include "sample/hemisphere.glsl"

float zeltner_roughness(float r) {
    return clamp(r, 0.01, 1.0);
}

float zeltner_albedo(float mu, float r) {
    r = zeltner_roughness(r);
    float s = r * (0.0206607 + 1.58491 * r) / (0.0379424 + r * (1.32227 + r));
    float m = r * (-0.193854 + r * (-1.14885 + r * (1.7932 - 0.95943 * r * r))) / (0.046391 + r);
    float o = r * (0.000654023 + r * (-0.0207818 + 0.119681 * r)) / (1.26264 + r * (-1.92021 + r));
    float x = (mu - m) / s;
    return clamp(exp(-0.5 * x * x) / (s * sqrt(2.0 * PI)) + o, 0.0, 1.0);
}

// (a, b)
vec2 zeltner_transform(float mu, float r) {
    r = zeltner_roughness(r);
    float a = r * (2.58126 * mu + 0.813703 * r) / (1.0 + mu * (0.310327 * mu + 2.60994 * r));
    float b = sqrt(max(1.0 - mu, 0.0)) * (r - 1.0) * r * r * r
            / (0.0000254053 + 1.71228 * mu - 1.71506 * mu * r + 1.34174 * r * r);
    return vec2(a, b);
}

// D / NoL, with LoV the cosine between wo and wi. wi.x = (LoV - NoV NoL) / sin(wo); along the normal b is 0.
float zeltner_over_cosine(vec2 ab, float NoV, float NoL, float LoV) {
    float x = (LoV - NoV * NoL) * inversesqrt(max(1.0 - NoV * NoV, 1e-6));
    float along = ab.x * x + ab.y * NoL;
    float across2 = ab.x * ab.x * max(1.0 - NoL * NoL - x * x, 0.0);
    float l2 = along * along + across2 + NoL * NoL;
    return INV_PI * ab.x * ab.x / (l2 * l2);
}

// A direction of D: a cosine's, taken back by the inverse of A. u in [0, 1)^2
vec3 zeltner_sample(vec2 ab, vec3 wo, vec2 u) {
    vec3 c = sample_cosine_hemisphere(u);
    vec2 xy = vec2(c.x - ab.y * c.z, c.y) / ab.x;
    float l = length(wo.xy);
    vec2 t = l > 1e-6 ? wo.xy / l : vec2(1.0, 0.0);
    return normalize(vec3(xy.x * t.x - xy.y * t.y, xy.x * t.y + xy.y * t.x, c.z));
}
