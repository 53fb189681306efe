// Surfaces that transmit light. The BSDF is a mixture: glass with the weight `transmission`, and an opaque surface with
// the remaining weight. Both have the same dielectric interface, so the mixture is exact.
#include "bsdf/glass.glsl"
#if HAS_PARTLY_GLASS || SHEEN
#include "bsdf/surface_of.glsl"
#elif CLEARCOAT
#include "bsdf/layer/coat.glsl"
#endif
#include "trace/emission.glsl"

#define TRANSMITS 1
#define REFRACTS 1
#define GUIDED 0

struct Bsdf {
    Glass glass;
#if CLEARCOAT
    Coat coat; // over the glass; the view of the surface has its own
#endif
#if SHEEN
    Sheen sheen; // likewise
    float sheen_probability;
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
#if SHEEN
    if (!i.is_front && !m.is_thin) m.inputs.sheen_color = vec3(0.0);
    b.sheen = make_sheen(m.inputs.sheen_color, m.inputs.sheen_roughness, wo.z);
    float reflected = luminance(b.sheen.albedo);
    b.sheen_probability = reflected / max(reflected + b.sheen.throughput, 1e-6);
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

// rgb: f |cos|, w: the pdf of sample_glass, of the glass and of what lies over it
vec4 glass_part(Bsdf b, vec3 wo, vec3 wi) {
    vec4 f = glass_eval_pdf(b.glass, wo, wi, u_dfg) * vec4(vec3(abs(wi.z)), 1.0);
#if SHEEN
    // As facets, glass is dimmed for the viewer's direction alone: it does not scatter light to all sides.
    vec4 fibres = vec4(0.0);
    if (wi.z > 0.0) {
        Angles a = local_angles(wo, wi);
        fibres = vec4(sheen_response(b.sheen, a) * wi.z, sheen_pdf(b.sheen, a));
    }
    f = vec4(sheen_over(b.sheen, fibres.rgb, f.rgb), mix(f.w, fibres.w, b.sheen_probability));
#endif
#if CLEARCOAT
    f = coat_eval_pdf(b.coat, wo, wi, f, u_dfg);
#endif
    return f;
}

vec4 bsdf_eval_pdf(Bsdf b, vec3 wo, vec3 wi) {
    vec4 f = glass_part(b, wo, wi);
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

BsdfSample sample_below_coat(Bsdf b, vec3 wo, vec3 u) {
#if SHEEN
    float p = b.sheen_probability;
    if (u.z < p) return BsdfSample(sheen_sample(b.sheen, wo, u.xy), vec3(0.0), 0.0, REFLECTION, 1.0);
    u.z = min((u.z - p) / max(1.0 - p, 1e-6), 1.0 - 1.0 / 16777216.0);
    BsdfSample s = glass_sample(b.glass, wo, u, u_dfg);
    if ((s.flags & DELTA) != 0u) {
        s.weight *= b.sheen.throughput / max(1.0 - p, 1e-6);
        s.pdf *= 1.0 - p;
    }
    return s;
#else
    return glass_sample(b.glass, wo, u, u_dfg);
#endif
}

BsdfSample sample_glass(Bsdf b, vec3 wo, vec3 u) {
#if CLEARCOAT || SHEEN
    BsdfSample s;
#if CLEARCOAT
    bool is_coat = coat_is_chosen(b.coat, u);
    if (is_coat) s = coat_sample(b.coat, wo, u.xy);
    else s = sample_below_coat(b, wo, u);
    if ((s.flags & DELTA) != 0u) return coat_delta(b.coat, is_coat, s);
#else
    s = sample_below_coat(b, wo, u);
    if ((s.flags & DELTA) != 0u) return s;
#endif
    if (s.flags == 0u) return s;
    vec4 f = glass_part(b, wo, s.wi);
    s.weight = f.rgb / max(f.w, 1e-30);
    s.pdf = f.w;
    return s;
#else
    return sample_below_coat(b, wo, u);
#endif
}

BsdfSample bsdf_sample(Bsdf b, vec3 wo, vec3 u, out float worth) {
    worth = HAS_CAUSTIC_GUIDE == 1 ? 1e3 : 1.0; // no path ends by what it carries where a guide may have sent it
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
