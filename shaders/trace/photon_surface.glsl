// Shades a path from a light, a photon, at a surface of any kind (trace/shade.glsl): connects it to the camera, and
// samples the next direction. Paths from the camera find all light whose vertex next to the lamp is not a delta lobe
// (next-event estimation), and none of the rest. So a photon goes on from its first vertex only by a delta lobe, and is
// connected at every later vertex: each path of light is counted once. Shadow rays pass panes (trace/pane.glsl), so
// these are no vertices of a photon before its first one.
// The path carries flux. A surface turns the flux that comes from wi to radiance towards wo by
//   f(wo, wi) |n_s.wi| |n_g.wo| / |n_g.wi|      Veach 1997, 5.3
// where f, with its shading normal n_s, is the BSDF that a path from the camera, which comes by wo, finds. f has a
// factor for radiance in glass, so that nothing of the kind is left to do. n_g is the geometric normal.
#include "trace/connect.glsl"

uniform bool u_lamps_pass_panes; // whether it is shadow rays that bring their light through panes

// That factor; `side` is that of the light, as side_of gives it.
vec3 adjoint(Hit hit, SurfaceMaterial m, vec3 wo, vec3 wi, out Interaction i, out float side) {
    i = interact(hit, wo);
    mat3 frame;
    vec3 local_wo;
    Bsdf bsdf = bsdf_towards(i, m, wo, frame, local_wo);
    vec3 local_wi = wi * frame;
    side = side_of(i, wi, local_wi.z);
    if (side == 0.0) return vec3(0.0);
    return bsdf_eval_pdf(bsdf, local_wo, local_wi).rgb
         * abs(dot(wo, i.n_geometric) / dot(wi, i.n_geometric));
}

// The window of a light of finite range (light/attenuation.glsl), which ends at the first surface
float range_window(float inv_range2, float distance) {
    float x = distance * distance * inv_range2;
    return clamp(1.0 - x * x, 0.0, 1.0);
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    Hit hit = unpack_hit(texelFetch(u_hit, texel, 0));
    Path p = read_path(texel, uvec4(0u));
    p.radiance = vec3(0.0); // trace/splat.vert has taken it
    Sample s = path_sample(texel, p.left);
    vec3 wi = -p.direction;
    Interaction i = interact(hit, wi);
    SurfaceMaterial m = material_at(i);
    vec4 u_bsdf = vertex_numbers(s, p, BSDF_GROUP);
    if (continues_straight(p, m, false, vertex_numbers(s, p, LIGHT_GROUP).w)) {
        continue_straight(p, i);
        write_path(p, IN_FLIGHT);
        return;
    }
#if DISPERSIVE && REFRACTS
    disperse(p, m, sample_numbers(s, CAMERA_GROUP).z);
#endif
    float way = distance(p.origin, i.position);
#if HAS_NESTED && REFRACTS
    if (!m.is_thin && !meets_boundary(p, i, m)) {
        if (p.depth == 0) p.throughput *= range_window(p.pdf, p.travelled + way);
        float last = p.depth > 0 && p.pdf > 0.0 ? FROM_DELTA : 0.0; // shadow rays to the camera stop here, too
        pass_displaced(p, i);
        p.pdf = last;
        write_path(p, IN_FLIGHT);
        return;
    }
#endif
#if HAS_PANES
    vec3 arriving = p.throughput;
#endif
    if (p.depth == 0) p.throughput *= range_window(p.pdf, p.travelled + way);
#if HAS_SCATTERING
    pass_medium(p, way);
#else
    pass_medium(p, p.travelled + way);
#endif
    bool is_back = TRANSMITS == 0 && !i.is_front && !m.is_double_sided;
    if (is_back || m.is_unlit || p.depth >= u_bounces) {
        write_path(p, ENDED);
        return;
    }

    mat3 frame;
    vec3 local_wi;
    Bsdf bsdf = bsdf_towards(i, m, wi, frame, local_wi);
    float worth; // what a guide says, which photons have none of
    BsdfSample b = bsdf_sample(bsdf, local_wi, u_bsdf.xyz, worth);
    vec3 next = normalize(frame * b.wi);
    float side = side_of(i, next, b.wi.z);
#if HAS_PANES && REFRACTS
    if (p.depth == 0 && u_lamps_pass_panes && passes_pane(m, b)) {
        pass_pane(p, i, arriving, b.weight);
        return;
    }
#endif
    bool is_delta = (b.flags & DELTA) != 0u;
    bool continues = b.flags != 0u && side != 0.0 && (is_delta || p.depth > 0);

    // To the camera; and, if the next direction is not that of a delta lobe, on in that direction. A loop, so
    // that a program has the BSDF once.
    CameraSample c = sample_camera(i.position);
    vec3 weight = b.weight;
    bool connects = p.depth > 0 && c.importance > 0.0;
    for (int k = connects ? 0 : 1; k < (continues && !is_delta ? 2 : 1); ++k) {
        Interaction seen;
        float light_side;
        vec3 f = adjoint(hit, m, k == 0 ? c.direction : next, wi, seen, light_side);
        if (k == 1) {
            weight = f / b.pdf;
        } else if (light_side != 0.0) {
#if TRANSMITS && REFRACTS && !HAS_SCATTERING && !HAS_NESTED
            // As begin_inside, for a camera that is inside the solid
            if (!seen.is_front && !m.is_thin) f /= max(m.inputs.ior * m.inputs.ior, 1.0);
#endif
            connect_camera(p, i.position, offset_origin(i.position, seen.n_geometric), c,
                           medium_at(p, i, m, light_side), p.throughput * f);
        }
    }
    if (is_delta) {
        // The flux of a delta lobe; b.weight is that of radiance, and what it reflects has both cosines alike.
        weight *= b.eta * b.eta * abs(dot(next, i.n_geometric) / dot(wi, i.n_geometric));
        if ((b.flags & TRANSMISSION) != 0u) weight *= abs(local_wi.z / b.wi.z);
    }
    p.medium = medium_at(p, i, m, side);
    float last = p.depth > 0 ? p.pdf : 0.0;
    if (!is_delta) last = FROM_ROUGH;
#if HAS_PANES && REFRACTS
    else if (last > 0.0 && !passes_pane(m, b)) last = FROM_DELTA; // through a pane, the camera sees the vertex before
#else
    else if (last > 0.0) last = FROM_DELTA;
#endif
    continues = continues && scatter(p, i.position, side * i.n_geometric, next, weight, last, u_bsdf.w, 0.95,
                                       1.0);
    write_path(p, continues ? IN_FLIGHT : ENDED);
}
