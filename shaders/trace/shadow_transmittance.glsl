// Shadow rays where something takes a part of their light: they pass boundaries between media of one index and panes
// (trace/pane.glsl), and are dimmed by media and panes on their way. viewer/trace/rays/embree.py does the same for
// Embree.
#include "trace/bvh.glsl"
#include "trace/interaction.glsl"
#if HAS_SCATTERING
#include "media/medium.glsl"
#endif
#if HAS_PANES
#include "trace/pane.glsl"
#endif

#if HAS_SCATTERING
// Transmittance of the medium between two places of a ray, in tracer units from its origin; d: unit length
vec3 transmittance_between(int nesting, vec3 o, vec3 d, float from, float to) {
    int medium = innermost(nesting);
    return transmittance(medium, length_in(medium, o, d, from, min(to, leaves_media(o, d))));
}
#endif

// The transmittance of the shadow ray from o along `vector`, 0 if it is occluded
vec3 shadow_transmittance(vec3 o, vec3 vector, int nesting) {
    vec3 transmitted = vec3(1.0);
    float size = length(vector), t = 0.0;
    vec3 d = vector / size;
    for (int k = 0; k < MAX_LAYERS; ++k) {
        Found found;
        bool is_hit = traverse(k == 0 ? o : o + t * d, vector, SHADOW_REACH - t / size, true, found);
        if (is_hit && !takes_part(found)) return vec3(0.0);
#if HAS_SCATTERING
        transmitted *= transmittance_between(nesting, o, d, t, is_hit ? t + found.t * size : size);
#endif
        if (!is_hit) return transmitted;
        Interaction i = interact(Hit(int(found.code & INSTANCE_MASK), int(found.triangle), found.barycentric), -d);
#if HAS_PANES
        if ((found.flags & IS_PANE) != 0u) transmitted *= pane_transmittance(i, -d);
        if (transmitted == vec3(0.0)) return transmitted;
#endif
#if HAS_SCATTERING
        if (is_boundary(found)) nesting = cross_boundary(nesting, i.medium, i.is_front);
#endif
        vec3 beyond = offset_origin(i.position, -i.n_geometric);
        t = dot(beyond - o, d);
    }
    return vec3(0.0);
}
