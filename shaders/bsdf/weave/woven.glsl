// The BSDF at a point of a woven cloth: a layer of fibres of one yarn, which light crosses, is mirrored by or is
// scattered in, to either side. The layer is that of Wang et al. 2022, "SpongeCake: A Layered Microflake Surface
// Appearance Model", of whose layers Zhu et al. 2023, "A Realistic Surface-based Cloth Rendering Model", make cloth.
// With Lambda(w) = sigma(w) / |w.z| and the optical thickness T of the layer, light is mirrored once by
//   f = D(h) / (4 |o.z| |i.z|) K,   K = (1 - exp(-T (Lo + Li))) / (Lo + Li)          on the side of wo,
//                                   K = (exp(-T Lo) - exp(-T Li)) / (Li - Lo)        on the other side
// A share exp(-T L) goes straight through, and a share S m is mirrored once (mirrored.glsl). The rest,
//   A(w) = 1 - exp(-T L) - S m(w),
// which is mirrored again or enters fibres, is the diffuse light. With pi f_d of a deep layer (depth.glsl), l <= pi f_d
// on the side of wo, a <= A and B = A - a, primes being means over the hemisphere by the cosine,
//   pi f = a (pi f_d + l (s(o) s(i) e / s' + (1 - s(o)) (1 - s(i)) / (1 - s') - 1)) + (1 - t) c B(o) B(i) / B'
//        = a pi f_d + t c B(o) B(i) / B' on the other side.
// All terms are reciprocal. If fibres absorb nothing, the first one gives a, the second none and the third B: no light
// is lost. Of light from w a share s(w) falls on the yarn here, and 1 - s on the yarns about it (woven_seen). Of what
// leaves here a share E gets past those; the rest is scattered again, so that e = E / (1 - c (1 - E)).
//
// Between yarns light goes straight on as far as they leave a gap, and else is scattered by them.
//
// As bsdf/bsdf.glsl, but wo and wi may lie on either side of the surface.
#include "bsdf/bsdf.glsl"
#include "bsdf/weave/depth.glsl"
#include "bsdf/weave/flakes.glsl"
#include "bsdf/weave/mirrored.glsl"
#include "media/one_minus_exp.glsl"
#include "sample/luminance.glsl"

struct Woven {
    vec3 axis;        // of the fibres, unit, in the frame of the surface; of a gap, any direction in the surface
    vec3 normal;      // of the yarn, unit, on the side of wo
    float alpha;      // how far their normals spread from perpendicular to it
    float thickness;  // T
    vec3 specular;    // share of the light that is mirrored where it meets a fibre
    vec3 diffuse;     // c: albedo of what is scattered in a thick yarn seen along the normal
    float through;    // t: share of the diffuse light that leaves on the other side, for fibres that absorb nothing
    vec3 below;       // c and t of the yarn that lies below; 0 and 1 without one
    float below_through;
    float slice;      // place in the table of mirrored.glsl
    float horizon;    // tangent of the angle to the surface's normal below which the next yarn hides light that comes
                      // from the side to which the yarn's normal leans
    vec2 gap;         // of a gap, such tangents of the yarns across the axis and along it; -1: no gap
};

// What depends on the yarns here and on |wo.z|, but not on how the fibres run: it is the same all over each yarn
struct WovenDeep {
    Depth depth;
    vec3 back, through; // shares of the light that comes out on the side of wo and on the other one
};

// What depends on the place and on wo
struct WovenView {
    Flakes flakes;
    float Lambda;     // of wo
    float straight;   // share of the light that meets no fibre
    float mirrored;   // share that leaves after it is mirrored once, for a specular share of 1
    vec3 rest;        // A(wo)
    vec3 least, mean; // of A
    float seen;       // s(wo)
    float mean_seen;
    vec3 here;        // e
    Depth depth;
    vec3 back, through; // shares of the diffuse light on either side
    vec3 diffuse;     // of both
    vec3 chance;      // of sampling what goes straight on, is mirrored, is diffuse
};

const float WOVEN_MIN_ALPHA = 0.02;

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

bool woven_is_gap(Woven m) {
    return m.gap.x >= 0.0;
}

// The share of light from w that meets fibres. Yarns beside a gap are straight cylinders, whose shadows are wider at a
// slant.
float woven_met(Woven m, Flakes f, vec3 w) {
    if (!woven_is_gap(m)) return one_minus_exp(min(m.thickness * woven_lambda(f, w), 80.0));
    vec2 across = abs(vec2(m.axis.x * w.y - m.axis.y * w.x, dot(m.axis.xy, w.xy)));
    bool is_open = all(lessThan(across, m.gap * abs(w.z)));
    return is_open ? 0.0 : one_minus_exp(min(m.thickness, 80.0));
}

// m(w), less than what meets fibres
float woven_mirrored(Woven m, vec3 w, float met, sampler2D table) {
    return woven_is_gap(m) ? 0.0 : min(mirrored_share(table, m.slice, m.axis, w), met);
}

// s(w). Light from the side from which the normal n leans away meets the yarn's own crown, by as much as it would come
// short of a plane with this normal: 1 + n.xy . w.xy / (n.z w.z). Light from the other side may be hidden by the next
// yarn.
float woven_seen(Woven m, vec3 w) {
    float lean = dot(m.normal.xy, w.xy) / (max(abs(m.normal.z), 1e-3) * max(abs(w.z), 1e-6));
    lean *= (m.normal.z < 0.0) == (w.z < 0.0) ? 1.0 : -1.0;
    float slope = length(m.normal.xy) / max(abs(m.normal.z), 1e-3);
    return lean > slope * m.horizon ? 0.0 : clamp(1.0 + lean, 0.0, 1.0);
}

// The share of directions, by the cosine, in which a gap is open: the form factor of a rectangle
float woven_open(vec2 gap) {
    vec2 r = sqrt(1.0 + gap * gap);
    return 2.0 * INV_PI * (gap.x / r.x * atan(gap.y / r.x) + gap.y / r.y * atan(gap.x / r.y));
}

WovenDeep woven_deep(vec3 color, float through, vec3 below, float below_through, float mu) {
    WovenDeep deep;
    deep.depth = depth_of(color, through);
    depth_lay_over(deep.depth, depth_of(below, below_through));
    depth_finish(deep.depth);
    depth_albedo(deep.depth, mu, deep.back, deep.through);
    return deep;
}

WovenView woven_view(Woven m, WovenDeep deep, vec3 wo, sampler2D table) {
    WovenView v;
    v.flakes = Flakes(m.axis, clamp(m.alpha, WOVEN_MIN_ALPHA, 1.0));
    v.Lambda = woven_lambda(v.flakes, wo);
    float met = woven_met(m, v.flakes, wo);
    v.straight = 1.0 - met;
    v.mirrored = woven_mirrored(m, wo, met, table);
    v.rest = met - m.specular * v.mirrored;
    if (woven_is_gap(m)) {
        v.least = vec3(0.0);
        v.mean = vec3(one_minus_exp(min(m.thickness, 80.0)) * (1.0 - woven_open(m.gap)));
        v.seen = v.mean_seen = 1.0;
        v.here = vec3(1.0);
    } else {
        // The least A is a concave function of S, hence no less than between its values for 0 and 1
        vec4 all = mirrored_statistics(table, m.slice);
        v.least = clamp(1.0 - all.x - m.specular * all.y, vec3(0.0), v.rest);
        v.mean = 1.0 - all.z - m.specular * all.w;
        float sine = length(m.normal.xy), cosine = max(abs(m.normal.z), 1e-3), secant = sqrt(1.0 + m.horizon * m.horizon);
        v.seen = woven_seen(m, wo);
        v.mean_seen = clamp(0.5 * (m.horizon / secant + cosine / (1.0 + sine)), 1e-3, 1.0); // (1 - sine) / cosine
        float away = 0.5 + 0.5 * (m.horizon * cosine - sine) / secant; // by the cosine to the yarn's normal
        v.here = away / max(1.0 - m.diffuse * (1.0 - away), 1e-6);
    }
    v.depth = deep.depth;
    vec3 above = max(v.rest - v.least, 0.0) * m.diffuse;
    v.back = v.least * (deep.back + v.depth.least * v.seen * (v.here - 1.0)) + (1.0 - m.through) * above;
    v.through = v.least * deep.through + m.through * above;
    v.diffuse = v.back + v.through;
    v.chance = vec3(v.straight, luminance(m.specular) * v.mirrored, luminance(v.diffuse));
    v.chance /= max(v.chance.x + v.chance.y + v.chance.z, 1e-20);
    return v;
}

WovenView woven_view(Woven m, vec3 wo, sampler2D table) {
    return woven_view(m, woven_deep(m.diffuse, m.through, m.below, m.below_through, abs(wo.z)), wo, table);
}

// f |cos| of the diffuse light
vec3 woven_diffuse(Woven m, WovenView v, vec3 wo, vec3 wi, sampler2D table) {
    float met = woven_met(m, v.flakes, wi);
    vec3 rest = met - m.specular * woven_mirrored(m, wi, met, table);
    vec3 above = max(v.rest - v.least, 0.0) * max(rest - v.least, 0.0) / max(v.mean - v.least, 1e-6) * m.diffuse;
    if (wi.z * wo.z < 0.0)
        return INV_PI * abs(wi.z) * (v.least * depth_through(v.depth, wo, wi) + m.through * above);
    float seen = woven_seen(m, wi);
    vec3 shape = v.here * (v.seen * seen / v.mean_seen) - 1.0;
    shape += v.mean_seen < 1.0 ? (1.0 - v.seen) * (1.0 - seen) / max(1.0 - v.mean_seen, 1e-6) : 0.0;
    vec3 layer = v.least * (depth_back(v.depth, wo, wi) + v.depth.least * shape);
    return INV_PI * abs(wi.z) * max(layer + (1.0 - m.through) * above, 0.0);
}

// Of samples of the diffuse light
float woven_share_through(WovenView v) {
    return luminance(v.through) / max(luminance(v.diffuse), 1e-20);
}

// xyz: f |cos|, w: the pdf, both without what goes straight on
vec4 woven_eval_pdf(Woven m, WovenView v, vec3 wo, vec3 wi, sampler2D table) {
    if (wo.z == 0.0 || wi.z == 0.0) return vec4(0.0);
    float side = wo.z * wi.z < 0.0 ? woven_share_through(v) : 1.0 - woven_share_through(v);
    vec4 f = vec4(woven_diffuse(m, v, wo, wi, table), v.chance.z * side * INV_PI * abs(wi.z));
    if (woven_is_gap(m)) return f;
    float mirrored = flakes_mirroring(v.flakes, wo, wi) / (4.0 * flakes_area(v.flakes, wo));
    return f + mirrored * vec4(m.specular * woven_weight(v, m.thickness, wo, wi), v.chance.y);
}

BsdfSample woven_sample(Woven m, WovenView v, vec3 wo, vec3 u, sampler2D table) {
    if (u.z < v.chance.x)
        return BsdfSample(-wo, vec3(v.straight / v.chance.x), v.chance.x, TRANSMISSION | DELTA, 1.0);
    vec3 wi;
    if (u.z < v.chance.x + v.chance.y) {
        vec3 h = flakes_sample(v.flakes, wo, u.xy);
        wi = 2.0 * dot(wo, h) * h - wo;
    } else {
        wi = sample_cosine_hemisphere(u.xy);
        float rest = (u.z - v.chance.x - v.chance.y) / max(v.chance.z, 1e-20);
        if ((wo.z < 0.0) != (rest < woven_share_through(v))) wi.z = -wi.z;
    }
    vec4 f = woven_eval_pdf(m, v, wo, wi, table);
    if (f.w <= 0.0) return NO_SAMPLE;
    return BsdfSample(wi, f.rgb / f.w, f.w, wi.z * wo.z < 0.0 ? TRANSMISSION : REFLECTION, 1.0);
}

vec3 woven_eval(Woven m, vec3 wo, vec3 wi, sampler2D table) {
    return woven_eval_pdf(m, woven_view(m, wo, table), wo, wi, table).rgb / max(abs(wi.z), 1e-20);
}

float woven_pdf(Woven m, vec3 wo, vec3 wi, sampler2D table) {
    return woven_eval_pdf(m, woven_view(m, wo, table), wo, wi, table).w;
}

BsdfSample woven_sample(Woven m, vec3 wo, vec3 u, sampler2D table) {
    return woven_sample(m, woven_view(m, wo, table), wo, u, table);
}

// Of all light but what goes straight on
vec3 woven_albedo(Woven m, vec3 wo, sampler2D table) {
    WovenView v = woven_view(m, wo, table);
    return m.specular * v.mirrored + v.diffuse;
}
