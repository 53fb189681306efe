// The layered BSDF of bsdf/surface.glsl, for the kinds of surfaces that have nothing else.
#include "bsdf/surface_of.glsl"
#include "trace/emission.glsl"

struct Bsdf {
    Surface surface;
    SurfaceView view;
};

Bsdf bsdf_at(Interaction i, SurfaceMaterial m, vec3 wo, vec3 n_coat) {
    Surface s = surface_of(m.inputs);
#if TRANSMITS
    if (!i.is_front && !m.is_thin) { // seen from inside the solid, which has coat and fibres outside
        s.coat = 0.0;
        s.sheen_color = vec3(0.0);
    }
#endif
    return Bsdf(s, surface_view(s, wo, n_coat, u_dfg));
}

vec4 bsdf_eval_pdf(Bsdf b, vec3 wo, vec3 wi) {
    return surface_eval_pdf(b.surface, b.view, wo, wi, u_dfg);
}

BsdfSample bsdf_sample(Bsdf b, vec3 wo, vec3 u) {
    return surface_sample(b.surface, b.view, wo, u, u_dfg);
}

#include "trace/shade.glsl"
