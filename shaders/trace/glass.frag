// Surfaces that transmit light. The material is its transmission's share glass, and for the rest opaque. Both lie under
// one interface, so that the mixture is exact.
#include "trace/glass.glsl"
#if HAS_PARTLY_GLASS
#include "trace/standard_surface.glsl"
#endif

#define TRANSMITS 1

uniform sampler2D u_dfg;

struct Surface {
    Glass glass;
#if HAS_PARTLY_GLASS
    Standard standard;
    StandardView view;
    float share; // of glass; the probability of its samples, too
#endif
};

Surface surface_of(Interaction i, SurfaceMaterial m, float NoV) {
    Surface s;
    s.glass = glass_of(i, m);
#if HAS_PARTLY_GLASS
    s.share = m.inputs.ior < 1.0 ? 0.0 : m.inputs.transmission * (1.0 - m.inputs.metallic);
    s.standard = standard_of(m);
    s.standard.metallic = min(m.inputs.metallic / max(1.0 - s.share, 1e-6), 1.0); // of the rest
    s.view = standard_view(s.standard, NoV, u_dfg);
#endif
    return s;
}

vec4 surface_eval_pdf(Surface s, vec3 wo, vec3 wi) {
    vec4 f = glass_eval_pdf(s.glass, wo, wi, u_dfg);
#if HAS_PARTLY_GLASS
    f = mix(standard_eval_pdf(s.standard, s.view, wo, wi, u_dfg), f, s.share);
#endif
    return f;
}

BsdfSample surface_sample(Surface s, vec3 wo, vec3 u) {
#if HAS_PARTLY_GLASS
    bool is_glass = u.z < s.share;
    u.z = is_glass ? u.z / s.share : (u.z - s.share) / (1.0 - s.share);
    u.z = min(u.z, 1.0 - 1.0 / 16777216.0);
    BsdfSample b;
    if (is_glass) b = glass_sample(s.glass, wo, u, u_dfg);
    else b = standard_sample_view(s.standard, s.view, wo, u, u_dfg);
    if ((b.flags & DELTA) == 0u && b.flags != 0u) { // the other might have chosen it, too
        vec4 f = surface_eval_pdf(s, wo, b.wi);
        b.weight = f.rgb * (abs(b.wi.z) / max(f.w, 1e-30));
        b.pdf = f.w;
    }
    return b;
#else
    return glass_sample(s.glass, wo, u, u_dfg);
#endif
}

#include "trace/shade.glsl"
