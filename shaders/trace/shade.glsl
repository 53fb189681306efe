// Shades a path at a surface of any kind: adds the emission, prepares a shadow ray to a light and samples the next
// direction. The file of a kind defines the following before it includes this file,
//   TRANSMITS                                   1 if light may leave on the other side, else 0
//   REFRACTS                                    1 if it is refracted there, so that radiance changes with the index
//   struct Bsdf                                 the BSDF for one wo
//   Bsdf bsdf_at(Interaction i, SurfaceMaterial m, vec3 wo, vec3 n_coat)
//   vec4 bsdf_eval_pdf(Bsdf b, vec3 wo, vec3 wi)     rgb: f |cos|, w: the pdf of bsdf_sample; 0 for delta lobes
//   BsdfSample bsdf_sample(Bsdf b, vec3 wo, vec3 u, out float worth)   for `worth` see scatter of trace/bounce.glsl
// with wo, wi and the normal n_coat of the clear coat in the frame of the shading normal (bsdf/bsdf.glsl).
// PHOTONS: paths come from lights, and trace/photon_surface.glsl shades them.
#include "trace/bounce.glsl"
#include "trace/write_state.glsl"
#if DISPERSIVE && REFRACTS
#include "bsdf/dispersion.glsl"
#endif
#if HAS_NESTED && REFRACTS
#include "trace/nested.glsl"
#endif
#include "trace/surface_sides.glsl"
#if HAS_LIGHTS && !PHOTONS
#include "trace/light_candidates.glsl"
#endif

#if TRANSMITS && !HAS_SCATTERING && !HAS_NESTED
// Begins a path whose camera is inside the solid. Such a camera shows radiance divided by the square of the index,
// which is the same on both sides of a surface, so that the picture does not become brighter when the camera moves
// inside.
void begin_inside(inout Path p, Interaction i, SurfaceMaterial m) {
    p.medium = i.medium;
#if REFRACTS
    p.eta2 = max(m.inputs.ior * m.inputs.ior, 1.0);
    p.throughput /= p.eta2;
#endif
}
#endif

#if DISPERSIVE && REFRACTS
// At its first dispersive surface a path takes a wavelength, which it keeps. The material gets the index for it.
void disperse(inout Path p, inout SurfaceMaterial m, float u) {
    if (m.inputs.dispersion <= 0.0) return;
    if (p.wavelength == 0.0) {
        vec3 weight;
        p.wavelength = sample_wavelength(u, weight);
        p.throughput *= weight;
    }
    m.inputs.ior = ior_at_wavelength(m.inputs.ior, m.inputs.dispersion, p.wavelength);
}
#endif

#if HAS_PANES && REFRACTS
// Whether a sample goes straight on through a pane (trace/pane.glsl)
bool passes_pane(SurfaceMaterial m, BsdfSample b) {
    return m.is_pane && b.flags == (TRANSMISSION | DELTA);
}

// The path goes on, and its last vertex stays. `arriving` is its throughput before the medium on its way to the pane.
void pass_pane(Path p, Interaction i, vec3 arriving, vec3 weight) {
    p.throughput = arriving * weight;
    continue_straight(p, i);
    write_path(p, p.throughput == vec3(0.0) ? ENDED : IN_FLIGHT);
}
#endif

#if PHOTONS
#include "trace/photon_surface.glsl"
#else
void main() {
    ivec2 texel = source_of(ivec2(gl_FragCoord.xy));
    uvec4 hit = texelFetch(u_hit, texel, 0);
    Path p = read_path(texel, hit);
    Sample s = path_sample(texel, p.left);
    vec3 wo = -p.direction;
    Interaction i = interact(unpack_hit(hit), wo);
    SurfaceMaterial m = material_at(i);
    bool is_back = TRANSMITS == 0 && !i.is_front && !m.is_double_sided;
    vec4 u_light = vertex_numbers(s, p, LIGHT_GROUP);
    vec4 u_bsdf = vertex_numbers(s, p, BSDF_GROUP);

#if HAS_SEE_THROUGH
    u_light.w = number_of_coverage(p, u_light.w);
    p.kept = left_of(u_light.w, m.coverage);
#endif
    if (continues_straight(p, m, is_back, u_light.w)) {
        continue_straight(p, i);
        write_path(p, IN_FLIGHT);
        return;
    }
#if DISPERSIVE && REFRACTS
    disperse(p, m, sample_numbers(s, CAMERA_GROUP).z);
#endif
#if TRANSMITS && !HAS_SCATTERING && !HAS_NESTED
    if (p.depth == 0 && !i.is_front && !m.is_thin) begin_inside(p, i, m);
#endif
#if HAS_NESTED && REFRACTS
    if (!m.is_thin && !meets_boundary(p, i, m)) {
        pass_displaced(p, i);
        write_path(p, IN_FLIGHT);
        return;
    }
#endif
#if HAS_PANES && REFRACTS
    vec3 arriving = p.throughput;
    // Where light samples were weighed against this path, it goes as far as their shadow rays do.
    bool may_pass = m.is_pane && p.pdf > 0.0;
#else
    const bool may_pass = false;
#endif
#if HAS_SCATTERING
    pass_medium(p, distance(p.origin, i.position));
#else
    pass_medium(p, p.travelled + distance(p.origin, i.position));
#endif
#if HAS_UNLIT && !TRANSMITS
    if (m.is_unlit && !is_back) {
        p.radiance += clamped(p.throughput * m.inputs.base_color.rgb, p.depth);
        write_path(p, ENDED);
        return;
    }
#endif
    add_emission(p, i, m, wo);
    bool is_last = p.depth >= u_bounces;
    if (is_back || is_last && !may_pass) {
        write_path(p, ENDED);
        return;
    }

    mat3 frame;
    vec3 local_wo;
    Bsdf bsdf = bsdf_towards(i, m, wo, frame, local_wo);
#if HAS_LIGHTS
#if HAS_LIGHT_TREE
    float facing = TRANSMITS == 1 ? 0.0 : pack_facing(i.n_geometric);
    vec3 n_light = unpack_facing(facing);
#else
    const vec3 n_light = vec3(0.0);
#endif
#if HAS_SEE_THROUGH
    u_light.w = p.kept;
    p.kept = 0.0;
#endif
    int candidates = p.depth == 0 ? FIRST_CANDIDATES : LATER_CANDIDATES;
    SurfaceLight lit = sample_light_at(i, bsdf, frame, local_wo, n_light, u_light, candidates);
    if (lit.side != 0.0 && !(may_pass && is_last))
        send_shadow_ray(p, i.position, lit.side * i.n_geometric, medium_at(p, i, m, lit.side), lit.light, lit.f_cos,
                        lit.pdf);
#endif
    float worth;
    BsdfSample b = bsdf_sample(bsdf, local_wo, u_bsdf.xyz, worth);
    vec3 wi = normalize(frame * b.wi);
    float side = side_of(i, wi, b.wi.z);
#if HAS_PANES && REFRACTS
    if (may_pass && passes_pane(m, b)) {
        pass_pane(p, i, arriving, b.weight);
        return;
    }
#endif
#if HAS_LIGHT_TREE
    p.facing = facing; // not of a pane that was passed
#endif
    bool continues = b.flags != 0u && side != 0.0 && !(may_pass && is_last);
#if TRANSMITS
    p.eta2 *= b.eta * b.eta;
#endif
#if HAS_SCATTERING
    bool is_within = TRANSMITS == 1 && !i.is_front && side > 0.0 && scatters(medium_of(innermost(p.medium)));
#endif
    p.medium = medium_at(p, i, m, side);
    float pdf = (b.flags & DELTA) != 0u ? 0.0 : b.pdf;
#if HAS_LIGHTS
    pdf /= float(candidates); // as sample_light_at weighs them
#endif
    // The throughput of long paths must not grow: those in media and between faces of white glass are long.
    float most = HAS_SCATTERING == 1 || HAS_NESTED == 1 ? 1.0 : 0.95;
    continues = continues && scatter(p, i.position, side * i.n_geometric, wi, b.weight, pdf, u_bsdf.w, most, worth);
#if HAS_SCATTERING
    if (is_within && p.depth > 2) { // what a scattering medium keeps in is no reflection that `bounces` counts
        --p.depth;
        ++p.steps;
    }
#endif
    write_path(p, continues ? IN_FLIGHT : ENDED);
}
#endif
