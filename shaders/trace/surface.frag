// Opaque surfaces: the lobe of bsdf/lobe/standard.glsl.
#include "trace/standard_surface.glsl"

#define TRANSMITS 0

uniform sampler2D u_dfg;

struct Surface {
    Standard standard;
    StandardView view;
};

Surface surface_of(Interaction i, SurfaceMaterial m, float NoV) {
    Standard standard = standard_of(m);
    return Surface(standard, standard_view(standard, NoV, u_dfg));
}

vec4 surface_eval_pdf(Surface s, vec3 wo, vec3 wi) {
    return standard_eval_pdf(s.standard, s.view, wo, wi, u_dfg);
}

BsdfSample surface_sample(Surface s, vec3 wo, vec3 u) {
    return standard_sample_view(s.standard, s.view, wo, u, u_dfg);
}

#include "trace/shade.glsl"
