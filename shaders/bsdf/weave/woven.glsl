// The BSDF at a point of a woven cloth: a layer of fibres of one yarn, which light crosses, is mirrored by or is
// scattered in, to either side. The layer is that of Wang et al. 2022, "SpongeCake: A Layered Microflake Surface
// Appearance Model", of whose layers Zhu et al. 2023, "A Realistic Surface-based Cloth Rendering Model", make cloth.
// With Lambda(w) = sigma(w) / |w.z| and the optical thickness T of the layer, light is mirrored once by
//   f = D(h) / (4 |o.z| |i.z|) K,   K = (1 - exp(-T (Lo + Li))) / (Lo + Li)          on the side of wo,
//                                   K = (exp(-T Lo) - exp(-T Li)) / (Li - Lo)        on the other side
// A share exp(-T Lo) goes straight through. What is left, since it is mirrored again in the layer or enters a fibre, is
// the yarn's diffuse light, of which a share leaves on the other side. It leaves by the cosine to the yarn's normal n;
// what that sends below the cloth meets other yarns and is taken to be sent back up, mirrored at the cloth:
//   f |i.z| = (max(n . i, 0) + max(n . i', 0)) / pi,   i' the mirror image of i
// White yarns keep all light, whatever their
// fibres' direction; but what the diffuse light takes depends on wo alone, so it is not reciprocal.
//
// As bsdf/bsdf.glsl, but wo and wi may lie on either side of the surface.
#include "bsdf/bsdf.glsl"
#include "bsdf/weave/flakes.glsl"
#include "media/one_minus_exp.glsl"
#include "sample/lattice.glsl"
#include "sample/luminance.glsl"

struct Woven {
    vec3 axis;        // of the fibres, unit, in the frame of the surface
    vec3 normal;      // of the yarn, unit, on the side of wo
    float alpha;      // how far their normals spread from perpendicular to it
    float thickness;  // T; 0 in a gap between yarns
    vec3 specular;    // share of the light that is mirrored where it meets a fibre
    vec3 diffuse;     // albedo of the rest
    float through;    // share of the diffuse light that leaves on the other side
};

// What depends on wo alone
struct WovenView {
    Flakes flakes;
    float Lambda;     // of wo
    float straight;   // share of the light that meets no fibre
    float mirrored;   // share that leaves after it is mirrored once, for a specular share of 1
    vec3 diffuse;     // share of the diffuse light
    vec3 chance;      // of sampling what goes straight on, is mirrored, is diffuse
};

const int WOVEN_POINTS = 32; // of the mean of what is mirrored
const float WOVEN_MIN_ALPHA = 0.02; // narrower lobes would lie between the points of the lattice

// The density of diffuse light on one side
float woven_diffuse(vec3 normal, vec3 wi) {
    float plane = dot(normal.xy, wi.xy), up = normal.z * abs(wi.z);
    return INV_PI * (max(plane + up, 0.0) + max(plane - up, 0.0));
}

float woven_lambda(Flakes f, vec3 w) {
    return flakes_area(f, w) / max(abs(w.z), 1e-6);
}

// K, both forms as (1 - exp(-x T)) / x
float woven_k(float T, float lambda_o, float lambda_i, bool is_through) {
    float x = max(is_through ? abs(lambda_o - lambda_i) : lambda_o + lambda_i, 1e-20);
    float k = T * x < 1e-8 ? T : one_minus_exp(min(T * x, 80.0)) / x;
    return is_through ? exp(-T * min(lambda_o, lambda_i)) * k : k;
}

// Lo K for the direction into which flake h mirrors wo: the weight of that sample
float woven_weight(WovenView v, float T, vec3 wo, vec3 wi) {
    return v.Lambda * woven_k(T, v.Lambda, woven_lambda(v.flakes, wi), wi.z * wo.z < 0.0);
}

// `points` are those of a set of `total` from `first` on.
WovenView woven_view(Woven m, vec3 wo, int first, int points, int total) {
    WovenView v;
    v.flakes = Flakes(m.axis, clamp(m.alpha, WOVEN_MIN_ALPHA, 1.0));
    v.Lambda = woven_lambda(v.flakes, wo);
    float depth = m.thickness * v.Lambda;
    v.straight = exp(-depth);
    // The mean weight of the samples, over a few points. It is at most the share that
    // meets fibres, and so is every weight.
    v.mirrored = 0.0;
    for (int k = 0; k < points; ++k) {

        vec2 u = hammersley(uint(first + k), uint(total));
        vec3 h = flakes_sample(v.flakes, wo, u);
        v.mirrored += woven_weight(v, m.thickness, wo, 2.0 * dot(wo, h) * h - wo);
    }
    float met = one_minus_exp(min(depth, 80.0));
    v.mirrored = min(v.mirrored / float(points), met);
    v.diffuse = m.diffuse * (met - m.specular * v.mirrored);
    v.chance = vec3(v.straight, luminance(m.specular) * v.mirrored, luminance(v.diffuse));
    v.chance /= max(v.chance.x + v.chance.y + v.chance.z, 1e-20);
    return v;
}

WovenView woven_view(Woven m, vec3 wo) {
    return woven_view(m, wo, 0, WOVEN_POINTS, WOVEN_POINTS);
}

// xyz: f |cos|, w: the pdf, both without what goes straight on
vec4 woven_eval_pdf(Woven m, WovenView v, vec3 wo, vec3 wi) {
    if (wo.z == 0.0 || wi.z == 0.0) return vec4(0.0);
    bool is_through = wo.z * wi.z < 0.0;
    float area = flakes_area(v.flakes, wo);
    float mirrored = flakes_mirroring(v.flakes, wo, wi) / (4.0 * area);
    float side = is_through ? m.through : 1.0 - m.through;
    float diffuse = side * woven_diffuse(m.normal, wi);
    vec3 f = m.specular * (mirrored * woven_weight(v, m.thickness, wo, wi)) + v.diffuse * diffuse;
    return vec4(f, v.chance.y * mirrored + v.chance.z * diffuse);
}

BsdfSample woven_sample(Woven m, WovenView v, vec3 wo, vec3 u) {
    if (u.z < v.chance.x)
        return BsdfSample(-wo, vec3(v.straight / v.chance.x), v.chance.x, TRANSMISSION | DELTA, 1.0);
    vec3 wi;
    if (u.z < v.chance.x + v.chance.y) {
        vec3 h = flakes_sample(v.flakes, wo, u.xy);
        wi = 2.0 * dot(wo, h) * h - wo;
    } else {
        wi = orthonormal_basis(m.normal) * sample_cosine_hemisphere(u.xy);
        float rest = (u.z - v.chance.x - v.chance.y) / max(v.chance.z, 1e-20);
        bool is_through = rest < m.through;
        wi.z = (wo.z < 0.0) != is_through ? -abs(wi.z) : abs(wi.z);
    }
    vec4 f = woven_eval_pdf(m, v, wo, wi);
    if (f.w <= 0.0) return NO_SAMPLE;
    return BsdfSample(wi, f.rgb / f.w, f.w, wi.z * wo.z < 0.0 ? TRANSMISSION : REFLECTION, 1.0);
}

vec3 woven_eval(Woven m, vec3 wo, vec3 wi) {
    return woven_eval_pdf(m, woven_view(m, wo), wo, wi).rgb / max(abs(wi.z), 1e-20);
}

float woven_pdf(Woven m, vec3 wo, vec3 wi) {
    return woven_eval_pdf(m, woven_view(m, wo), wo, wi).w;
}

BsdfSample woven_sample(Woven m, vec3 wo, vec3 u) {
    return woven_sample(m, woven_view(m, wo), wo, u);
}

// Of all light but what goes straight on
vec3 woven_albedo(Woven m, vec3 wo) {
    WovenView v = woven_view(m, wo);
    return m.specular * v.mirrored + v.diffuse;
}
