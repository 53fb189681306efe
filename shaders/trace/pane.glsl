// Panes: thin walls of glass that are smooth, so that light goes straight on through them
// (bsdf/lobe/thin_dielectric.glsl). Shadow rays pass them. A path that is transmitted keeps its last vertex, as if
// there were no pane, so that light samples and BSDF samples find the same light, and their weights are the same as
// without the pane. viewer/trace/scene/materials.py says which materials may have such points.
#include "trace/material.glsl"
#include "bsdf/glass.glsl"

uniform bool u_shows_specular; // SHOW_SPECULAR of the pictures, of which the programs of intersectors know nothing

// What a pane transmits of the light that comes straight from behind towards wo; 0 where it is not smooth
vec3 pane_transmittance(Interaction i, vec3 wo) {
    SurfaceMaterial m = material_at(i);
    if (!m.is_pane || !u_shows_specular) return vec3(0.0);
    float share = m.inputs.transmission * (1.0 - m.inputs.metallic);
    return share * wall_transmittance(glass_of(m.inputs, true, i.is_front), clamp(dot(i.n, wo), 0.0, 1.0));
}
