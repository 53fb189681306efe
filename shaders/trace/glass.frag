// Surfaces that transmit light. The BSDF is a mixture: glass with the weight `transmission`, and an opaque surface with
// the remaining weight. Both have the same dielectric interface, so the mixture is exact.
#include "bsdf/glass.glsl"
#if HAS_PARTLY_GLASS
#include "bsdf/surface_of.glsl"
#elif CLEARCOAT
#include "bsdf/layer/coat.glsl"
#endif
#include "trace/emission.glsl"

#define TRANSMITS 1
#define REFRACTS 1

struct Bsdf {
    Glass glass;
#if CLEARCOAT
    Coat coat; // over the glass; the view of the surface has its own
#endif
#if HAS_PARTLY_GLASS
    Surface surface;
    SurfaceView view;
    float share; // the weight of glass, which is also the probability of sampling it
#endif
};

Bsdf bsdf_at(Interaction i, SurfaceMaterial m, vec3 wo, vec3 n_coat) {
    Bsdf b;
#if CLEARCOAT
    if (!i.is_front && !m.is_thin) m.inputs.clearcoat = 0.0; // seen from inside the solid
    float roughness = m.inputs.clearcoat_roughness;
    b.coat = make_coat(m.inputs.clearcoat, roughness * roughness, n_coat, dot(n_coat, wo), u_dfg);
    b.coat.probability = coat_probability(b.coat, 1.0);
#endif
    b.glass = glass_of(m.inputs, m.is_thin, i.is_front);
#if HAS_PARTLY_GLASS
    b.share = m.inputs.transmission * (1.0 - m.inputs.metallic);
    b.surface = surface_of(m.inputs);
    b.surface.metallic = min(m.inputs.metallic / max(1.0 - b.share, 1e-6), 1.0); // of the opaque part
    b.view = surface_view(b.surface, wo, n_coat, u_dfg);
#endif
    return b;
}

vec4 bsdf_eval_pdf(Bsdf b, vec3 wo, vec3 wi) {
    vec4 f = glass_eval_pdf(b.glass, wo, wi, u_dfg) * vec4(vec3(abs(wi.z)), 1.0);
#if CLEARCOAT
    f = coat_eval_pdf(b.coat, wo, wi, f, u_dfg);
#endif
#if HAS_PARTLY_GLASS
    vec4 opaque = surface_eval_pdf(b.surface, b.view, wo, wi, u_dfg);
#if DIFFUSE_TRANSMISSION
    // Radiance is greater by eta^2 inside, however the light got there.
    if (wi.z < 0.0 && !b.glass.is_thin) opaque.rgb /= b.glass.eta * b.glass.eta;
#endif
    f = mix(opaque, f, b.share);
#endif
    return f;
}

BsdfSample sample_glass(Bsdf b, vec3 wo, vec3 u) {
#if CLEARCOAT
    BsdfSample s;
    bool is_coat = coat_is_chosen(b.coat, u);
    if (is_coat) s = coat_sample(b.coat, wo, u.xy);
    else s = glass_sample(b.glass, wo, u, u_dfg);
    if ((s.flags & DELTA) != 0u) return coat_delta(b.coat, is_coat, s);
    if (s.flags == 0u) return s;
    vec4 f = glass_eval_pdf(b.glass, wo, s.wi, u_dfg) * vec4(vec3(abs(s.wi.z)), 1.0);
    f = coat_eval_pdf(b.coat, wo, s.wi, f, u_dfg);
    s.weight = f.rgb / max(f.w, 1e-30);
    s.pdf = f.w;
    return s;
#else
    return glass_sample(b.glass, wo, u, u_dfg);
#endif
}

BsdfSample bsdf_sample(Bsdf b, vec3 wo, vec3 u) {
#if HAS_PARTLY_GLASS
    bool is_glass = u.z < b.share;
    u.z = is_glass ? u.z / b.share : (u.z - b.share) / (1.0 - b.share);
    u.z = min(u.z, 1.0 - 1.0 / 16777216.0);
    BsdfSample s;
    if (is_glass) s = sample_glass(b, wo, u);
    else s = surface_sample(b.surface, b.view, wo, u, u_dfg);
    if ((s.flags & DELTA) == 0u && s.flags != 0u) { // the other part of the mixture can sample this direction, too
        vec4 f = bsdf_eval_pdf(b, wo, s.wi);
        s.weight = f.rgb / max(f.w, 1e-30);
        s.pdf = f.w;
#if DIFFUSE_TRANSMISSION
        if (s.wi.z < 0.0 && !b.glass.is_thin) s.eta = b.glass.eta;
#endif
    }
    return s;
#else
    return sample_glass(b, wo, u);
#endif
}

#include "trace/shade.glsl"
