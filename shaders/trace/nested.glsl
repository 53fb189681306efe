// Boundaries of solids of glass that touch or overlap (viewer/trace/scene/nested.py). C. Schmidt, B. Budge: Simple
// Nested Dielectrics in Ray Traced Images, JGT 7(2), 2002: light is bent where the medium with the highest number
// changes, by the indices of both sides; a boundary behind which it stays the same is displaced by another solid, and
// is not there.
#if DISPERSIVE
#include "bsdf/dispersion.glsl"
#endif

// The index of refraction of a medium, for the path's wavelength
float index_in(int medium, Path p) {
    vec2 index = scene_float4(u_media + medium * MEDIUM_TEXELS + MEDIUM_TEXELS - 1).xy; // n_d, dispersion
#if DISPERSIVE
    if (p.wavelength > 0.0 && index.y > 0.0) return ior_at_wavelength(index.x, index.y, p.wavelength);
#endif
    return index.x;
}

// Whether the boundary is there. The material gets the index behind its front over that before it.
bool meets_boundary(Path p, Interaction i, inout SurfaceMaterial m) {
    int here = innermost(p.medium), there = innermost(cross_boundary(p.medium, i.medium, i.is_front));
    float eta = index_in(there, p) / index_in(here, p);
    m.inputs.ior = i.is_front ? eta : 1.0 / eta;
    return here != there;
}

// Takes the path through one that is not. Shadow rays stop there, so what the path finds behind it counts in full.
void pass_displaced(inout Path p, Interaction i) {
    float way = distance(p.origin, i.position);
#if HAS_SCATTERING
    pass_medium(p, way);
    p.is_lit = false;
#else
    pass_medium(p, p.travelled + way);
#endif
    p.medium = cross_boundary(p.medium, i.medium, i.is_front);
#if HAS_SCATTERING
    p.shadow_medium = p.medium;
#endif
    p.origin = offset_origin(i.position, -i.n_geometric);
    p.pdf = p.travelled = 0.0;
    p.depth = max(p.depth, 1); // a photon has met glass, and so has a camera ray
    ++p.steps;
}
