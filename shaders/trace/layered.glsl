// The layered BSDF of bsdf/surface.glsl, for the kinds of surfaces that have nothing else.
#include "bsdf/surface_of.glsl"
#include "trace/emission.glsl"

// Whether the caustic guide takes a share of the samples
#define GUIDED (HAS_CAUSTIC_GUIDE && !TRANSMITS && !PHOTONS)
#if GUIDED
#include "trace/caustic_guide.glsl"
#endif

struct Bsdf {
    Surface surface;
    SurfaceView view;
#if GUIDED
    Guide guide; // of the samples of bsdf_sample
#endif
};

Bsdf bsdf_at(Interaction i, SurfaceMaterial m, vec3 wo, vec3 n_coat) {
    Surface s = surface_of(m.inputs);
#if TRANSMITS
    if (!i.is_front && !m.is_thin) { // seen from inside the solid, which has coat and fibres outside
        s.coat = 0.0;
        s.sheen_color = vec3(0.0);
    }
#endif
#if GUIDED
    return Bsdf(s, surface_view(s, wo, n_coat, u_dfg), NO_GUIDE);
#else
    return Bsdf(s, surface_view(s, wo, n_coat, u_dfg));
#endif
}

#if GUIDED
// The share of samples that go to all sides, which may be guided
float roughly_reflected(Bsdf b) {
    return 1.0 - facet_probability(b.surface, b.view);
}

vec4 bsdf_eval_pdf(Bsdf b, vec3 wo, vec3 wi) {
    vec4 f = surface_eval_pdf(b.surface, b.view, wo, wi, u_dfg);
    f.w = mix(f.w, guide_pdf(b.guide, wi), b.guide.share);
    return f;
}

// A guided sample carries little, but so much more often meets a lamp; and what smooth bodies reflect may come from it.
BsdfSample bsdf_sample(Bsdf b, vec3 wo, vec3 u, out float worth) {
    bool is_rough = roughly_reflected(b) >= 0.5;
    worth = is_rough ? 1.0 : ALWAYS_WORTH;
    float share = b.guide.share;
    bool is_guided = u.z < share;
    u.z = min(is_guided ? u.z / share : (u.z - share) / (1.0 - share), 1.0 - 1.0 / 16777216.0);
    BsdfSample s;
    if (is_guided) s = BsdfSample(guide_direction(b.guide, u), vec3(0.0), 0.0, REFLECTION, 1.0);
    else s = surface_direction(b.surface, b.view, wo, u, u_dfg);
    if (s.flags == 0u) return s;
    if ((s.flags & DELTA) != 0u) {
        s.weight /= 1.0 - share;
        s.pdf *= 1.0 - share;
        return s;
    }
    vec4 f = surface_eval_pdf(b.surface, b.view, wo, s.wi, u_dfg);
    s.pdf = mix(f.w, guide_pdf(b.guide, s.wi), share);
    s.weight = f.rgb / max(s.pdf, 1e-30);
    if (is_rough) worth = s.pdf / max(f.w, 1e-30); // what it would carry without the guide, over what it carries
    return s;
}
#else
vec4 bsdf_eval_pdf(Bsdf b, vec3 wo, vec3 wi) {
    return surface_eval_pdf(b.surface, b.view, wo, wi, u_dfg);
}

BsdfSample bsdf_sample(Bsdf b, vec3 wo, vec3 u, out float worth) {
    worth = 1.0;
    return surface_sample(b.surface, b.view, wo, u, u_dfg);
}
#endif

#include "trace/shade.glsl"
