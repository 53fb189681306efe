// Slots whose ray met a surface that transmits light: as surface.frag, with both sides of it.
// The material is its transmission's share glass, and for the rest opaque. Both lie under one interface, so that the
// mixture is exact.
#include "trace/bounce.glsl"
#include "trace/glass.glsl"
#if HAS_PARTLY_GLASS
#include "trace/standard_surface.glsl"
#endif

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
    Surface x;
    x.glass = glass_of(i, m);
#if HAS_PARTLY_GLASS
    x.share = m.inputs.ior < 1.0 ? 0.0 : m.inputs.transmission * (1.0 - m.inputs.metallic);
    x.standard = standard_of(m);
    x.standard.metallic = min(m.inputs.metallic / max(1.0 - x.share, 1e-6), 1.0); // of the rest
    x.view = standard_view(x.standard, NoV, u_dfg);
#endif
    return x;
}

// f, and in w the pdf
vec4 eval_pdf(Surface x, vec3 wo, vec3 wi) {
    vec4 f = glass_eval_pdf(x.glass, wo, wi, u_dfg);
#if HAS_PARTLY_GLASS
    f = mix(standard_eval_pdf(x.standard, x.view, wo, wi, u_dfg), f, x.share);
#endif
    return f;
}

BsdfSample sample_surface(Surface x, vec3 wo, vec3 u) {
#if HAS_PARTLY_GLASS
    bool is_glass = u.z < x.share;
    u.z = is_glass ? u.z / x.share : (u.z - x.share) / (1.0 - x.share);
    u.z = min(u.z, 1.0 - 1.0 / 16777216.0);
    BsdfSample s;
    if (is_glass) s = glass_sample(x.glass, wo, u, u_dfg);
    else s = standard_sample_view(x.standard, x.view, wo, u, u_dfg);
    if ((s.flags & DELTA) == 0u && s.flags != 0u) { // the other might have chosen it, too
        vec4 f = eval_pdf(x, wo, s.wi);
        s.weight = f.rgb * (abs(s.wi.z) / max(f.w, 1e-30));
        s.pdf = f.w;
    }
    return s;
#else
    return glass_sample(x.glass, wo, u, u_dfg);
#endif
}

// The camera is in the body. What it shows is radiance over the index squared, which no surface changes: a picture does
// not become brighter when the camera dives in.
void begin_inside(inout Path p, SurfaceMaterial m) {
    p.sigma = m.sigma;
    p.eta2 = max(m.inputs.ior * m.inputs.ior, 1.0);
    p.throughput /= p.eta2;
}

void main() {
    ivec2 slot = ivec2(gl_FragCoord.xy);
    uvec4 word = texelFetch(u_hit, slot, 0);
    Path p = read_path(slot, word);
    Sample s = slot_sample(slot, p.left);
    vec3 wo = -p.direction;
    Interaction i = interact(unpack_hit(word), wo);
    SurfaceMaterial m = material_at(i);
    vec4 for_light = vertex_numbers(s, p, LIGHT_GROUP);
    vec4 for_bsdf = vertex_numbers(s, p, BSDF_GROUP);

    if (goes_on(p, i, m, false, for_light.w)) {
        pass_through(p, i);
        write_path(p, IN_FLIGHT);
        return;
    }
    if (p.depth == 0 && !i.is_front && !m.is_thin) begin_inside(p, m);
    p.throughput *= transmittance(p, p.travelled + distance(p.origin, i.position));
    meet_emission(p, i, m, wo);
    if (p.depth >= u_bounces) {
        write_path(p, ENDED);
        return;
    }

    mat3 frame = mat3(i.t, i.b, i.n);
    vec3 local_wo = wo * frame;
    Surface x = surface_of(i, m, local_wo.z);
    vec3 before = p.sigma;
    vec3 beyond = i.is_front && !m.is_thin ? m.sigma : m.is_thin ? before : vec3(0.0);
#if HAS_LIGHTS
    LightSample light = sample_light(i.position, for_light.xyz);
    vec3 local_wi = light.direction * frame;
    float side = dot(light.direction, i.n_geometric);
    if (side * local_wi.z > 0.0) { // on the side of the surface that the shading normal says
        if (side < 0.0) p.sigma = beyond;
        vec4 f = eval_pdf(x, local_wo, local_wi);
        connect(p, i.position, sign(side) * i.n_geometric, light, f.rgb * abs(local_wi.z), f.w);
        p.sigma = before;
    }
#endif
    BsdfSample b = sample_surface(x, local_wo, for_bsdf.xyz);
    vec3 wi = normalize(frame * b.wi);
    float side_b = dot(wi, i.n_geometric);
    bool goes = b.flags != 0u && side_b * b.wi.z > 0.0;
    if (goes && b.wi.z < 0.0) p.sigma = beyond;
    p.eta2 *= b.eta * b.eta;
    float pdf = (b.flags & DELTA) != 0u ? 0.0 : b.pdf;
    goes = goes && scatter(p, i.position, sign(side_b) * i.n_geometric, wi, b.weight, pdf, for_bsdf.w);
    write_path(p, goes ? IN_FLIGHT : ENDED);
}
