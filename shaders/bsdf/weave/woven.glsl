// The BSDF at a point of a woven cloth: a layer of fibres of one yarn, which light crosses, is mirrored by or is
// scattered in, to either side. The layer is that of Wang et al. 2022, "SpongeCake: A Layered Microflake Surface
// Appearance Model", of whose layers Zhu et al. 2023, "A Realistic Surface-based Cloth Rendering Model", make cloth.
// With Lambda(w) = sigma(w) / |w.z| and the optical thickness T of the layer, light is mirrored once by
//   f = S R(phi) D(h) / (4 |o.z| |i.z|) K,
//   K = (1 - exp(-T max(Lo, Li))) / max(Lo, Li)      on the side of wo,
//   K = (exp(-T Lo) - exp(-T Li)) / (Li - Lo)        on the other side
// where SpongeCake has Lo + Li for the maximum: fibres of a yarn lie so close together that light leaves by the way
// that light has come on. R, at most 1, is Fresnel's reflectance by the azimuth about the fibre. What enters one fibre
// leaves by F of entered.glsl in the place of D / 4, less (1 - S) and what fibres absorb. A share exp(-T L) goes
// straight through; S m is mirrored once and (1 - S) n has entered one fibre (mirrored.glsl). The rest, for white
// fibres,
//   A(w) = 1 - exp(-T L) - S m(w) - (1 - S) n(w),
// which meets several, is the diffuse light. With pi f_d of a deep layer (depth.glsl), which sends the shares r and t
// of light from all around to either side, l <= pi f_d on the side of wo, a <= A and B = A - a, primes being means over
// the hemisphere by the cosine,
//   pi f = a (pi f_d + l (s(o) s(i) e / s' + (1 - s(o)) (1 - s(i)) / (1 - s') - 1)) + r B(o) B(i) / B'
//        = a pi f_d + t B(o) B(i) / B' on the other side.
// All terms are reciprocal. If fibres absorb nothing, the first one gives a, the second none and the third B: no light
// is lost. Of light from w a share s(w) falls on the yarn here, and 1 - s on the yarns about it (woven_seen). Of what
// leaves here a share E gets past those; the rest is scattered again, so that e = E / (1 - c (1 - E)).
//
// Between yarns light goes straight on as far as they leave a gap, and else is scattered by them.
//
// As bsdf/bsdf.glsl, but wo and wi may lie on either side of the surface.
#include "bsdf/weave/woven_view.glsl"

// f |cos| of the diffuse light
vec3 woven_diffuse(Woven m, WovenView v, vec3 wo, vec3 wi, sampler2D table) {
    float met = woven_met(m, v.flakes, wi);
    vec3 rest = woven_rest(m, met, woven_once(m, wi, met, table));
    vec3 above = max(v.rest - v.least, 0.0) * max(rest - v.least, 0.0) / max(v.mean - v.least, 1e-6);
    if (wi.z * wo.z < 0.0)
        return INV_PI * abs(wi.z) * (v.least * depth_through(v.depth, wo, wi) + depth_mean_through(v.depth) * above);
    float seen = woven_seen(m, wi);
    vec3 shape = v.here * (v.seen * seen / v.mean_seen) - 1.0;
    shape += v.mean_seen < 1.0 ? (1.0 - v.seen) * (1.0 - seen) / max(1.0 - v.mean_seen, 1e-6) : 0.0;
    vec3 layer = v.least * (depth_back(v.depth, wo, wi) + v.depth.least * shape);
    return INV_PI * abs(wi.z) * max(layer + depth_mean_back(v.depth) * above, 0.0);
}

// Of samples of the diffuse light
float woven_share_through(WovenView v) {
    return min(luminance(v.through + v.onwards) / max(luminance(v.diffuse), 1e-20), 1.0);
}

// xyz: f |cos|, w: the pdf, both without what goes straight on
vec4 woven_eval_pdf(Woven m, WovenView v, vec3 wo, vec3 wi, sampler2D table) {
    if (wo.z == 0.0 || wi.z == 0.0) return vec4(0.0);
    float side = wo.z * wi.z < 0.0 ? woven_share_through(v) : 1.0 - woven_share_through(v);
    vec4 f = vec4(woven_diffuse(m, v, wo, wi, table), v.chance.z * side * INV_PI * abs(wi.z));
    if (woven_is_gap(m)) return f;
    float mirrored = flakes_mirroring(v.flakes, wo, wi) / (4.0 * flakes_area(v.flakes, wo));
    float weight = woven_weight(v, m.thickness, wo, wi);
    float azimuth = azimuth_about(m.axis, wo, wi);
    vec2 entered = entered_once(m.axis, wo, wi, azimuth) * (weight / flakes_area(v.flakes, wo));
    f.rgb += (1.0 - m.specular) * (m.passed * entered.x + m.returned * entered.y);
    f.w += v.chance.w * entered_pdf(m.axis, wo, wi);
    return f + mirrored * vec4(m.specular * (flakes_fresnel(azimuth) * weight), v.chance.y);
}

BsdfSample woven_sample(Woven m, WovenView v, vec3 wo, vec3 u, sampler2D table) {
    if (u.z < v.chance.x)
        return BsdfSample(-wo, vec3(v.straight / v.chance.x), v.chance.x, TRANSMISSION | DELTA, 1.0);
    vec3 wi;
    if (u.z < v.chance.x + v.chance.y) {
        vec3 h = flakes_sample(v.flakes, wo, u.xy);
        wi = 2.0 * dot(wo, h) * h - wo;
    } else if (u.z >= 1.0 - v.chance.w) {
        wi = entered_sample(m.axis, wo, u.xy);
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
