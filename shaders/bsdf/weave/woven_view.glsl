// What a woven cloth does with light from one direction, in the terms of bsdf/weave/woven.glsl: the shares that go
// straight on, meet one fibre and are left for the diffuse light.
#include "bsdf/bsdf.glsl"
#include "bsdf/weave/depth.glsl"
#include "bsdf/weave/entered.glsl"
#include "bsdf/weave/flakes.glsl"
#include "bsdf/weave/mirrored.glsl"
#include "media/one_minus_exp.glsl"
#include "sample/luminance.glsl"

struct Woven {
    vec3 axis;        // of the fibres, unit, in the frame of the surface; of a gap, any direction in the surface
    vec3 normal;      // of the yarn, unit, on the side of wo
    float alpha;      // how far their normals spread from perpendicular to it
    float thickness;  // T
    vec3 specular;    // share S of the light that fibres mirror where they mirror most of it
    vec3 passed;      // share left of light that went through a fibre
    vec3 returned;    // share left of light that was reflected inside of one
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
    float entered;    // share that leaves after it has entered one fibre, for a specular share of 0
    vec3 rest;        // A(wo)
    vec3 least, mean; // of A
    float seen;       // s(wo)
    float mean_seen;
    vec3 here;        // e
    Depth depth;
    vec3 back, through; // shares of the diffuse light on either side
    vec3 once, onwards; // of what has entered one fibre: all, and what leaves on the other side
    vec3 diffuse;     // all of these
    vec4 chance;      // of sampling what goes straight on, is mirrored, is diffuse, goes through fibres
};

const float WOVEN_MIN_ALPHA = 0.02;

float woven_lambda(Flakes f, vec3 w) {
    return flakes_area(f, w) / max(abs(w.z), 1e-6);
}

// K, both forms as (1 - exp(-x T)) / x
float woven_k(float T, float lambda_o, float lambda_i, bool is_through) {
    float x = max(is_through ? abs(lambda_o - lambda_i) : max(lambda_o, lambda_i), 1e-20);
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

// m(w) and n(w), less than what meets fibres
vec2 woven_once(Woven m, vec3 w, float met, sampler2D table) {
    return woven_is_gap(m) ? vec2(0.0) : min(once_shares(table, m.slice, m.axis, w), met);
}

// A(w)
vec3 woven_rest(Woven m, float met, vec2 once) {
    return met - mix(vec3(once.y), vec3(once.x), m.specular);
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
    vec2 once = woven_once(m, wo, met, table);
    v.mirrored = once.x;
    v.entered = once.y;
    v.rest = woven_rest(m, met, once);
    if (woven_is_gap(m)) {
        v.least = vec3(0.0);
        v.mean = vec3(one_minus_exp(min(m.thickness, 80.0)) * (1.0 - woven_open(m.gap)));
        v.seen = v.mean_seen = 1.0;
        v.here = vec3(1.0);
    } else {
        // The least A is a concave function of S, hence no less than between its values for 0 and 1
        vec4 all = once_statistics(table, m.slice);
        v.least = clamp(1.0 - mix(vec3(all.y), vec3(all.x), m.specular), vec3(0.0), v.rest);
        v.mean = 1.0 - mix(vec3(all.w), vec3(all.z), m.specular);
        float sine = length(m.normal.xy), cosine = max(abs(m.normal.z), 1e-3);
        float secant = sqrt(1.0 + m.horizon * m.horizon);
        v.seen = woven_seen(m, wo);
        v.mean_seen = clamp(0.5 * (m.horizon / secant + cosine / (1.0 + sine)), 1e-3, 1.0); // (1 - sine) / cosine
        float away = 0.5 + 0.5 * (m.horizon * cosine - sine) / secant; // by the cosine to the yarn's normal
        v.here = away / max(1.0 - m.diffuse * (1.0 - away), 1e-6);
    }
    v.depth = deep.depth;
    vec3 above = max(v.rest - v.least, 0.0);
    // Of what has entered one fibre about this much leaves on the other side: what was let through by it alone
    vec3 entered = (1.0 - m.specular) * (m.passed * ENTERED_SHARE.x + m.returned * ENTERED_SHARE.y);
    float onwards = min(m.thickness * v.Lambda * v.straight, v.entered);
    v.back = v.least * (deep.back + v.depth.least * v.seen * (v.here - 1.0)) + depth_mean_back(v.depth) * above;
    v.through = v.least * deep.through + depth_mean_through(v.depth) * above;
    v.once = entered * v.entered;
    v.onwards = entered * onwards;
    v.diffuse = v.back + v.through + v.once;
    float through_fibres = 0.75 * luminance(entered) * v.entered; // the rest as if it were diffuse
    v.chance = vec4(v.straight, luminance(m.specular) * v.mirrored,
                    max(luminance(v.diffuse) - through_fibres, 0.0), through_fibres);
    v.chance /= max(dot(v.chance, vec4(1.0)), 1e-20);
    return v;
}

WovenView woven_view(Woven m, vec3 wo, sampler2D table) {
    return woven_view(m, woven_deep(m.diffuse, m.through, m.below, m.below_through, abs(wo.z)), wo, table);
}
