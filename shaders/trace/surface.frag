// Slots whose ray met an opaque surface: its light, a shadow ray to a light, and the next direction.
#include "trace/bounce.glsl"
#include "trace/standard_surface.glsl"

uniform sampler2D u_dfg;

void main() {
    ivec2 slot = ivec2(gl_FragCoord.xy);
    uvec4 word = texelFetch(u_hit, slot, 0);
    Path p = read_path(slot, word);
    Sample s = slot_sample(slot, p.left);
    vec3 wo = -p.direction;
    Interaction i = interact(unpack_hit(word), wo);
    SurfaceMaterial m = material_at(i);
    bool is_back = !i.is_front && !m.is_double_sided;
    vec4 for_light = vertex_numbers(s, p, LIGHT_GROUP);
    vec4 for_bsdf = vertex_numbers(s, p, BSDF_GROUP);

    if (goes_on(p, i, m, is_back, for_light.w)) {
        pass_through(p, i);
        write_path(p, IN_FLIGHT);
        return;
    }
    p.throughput *= transmittance(p, p.travelled + distance(p.origin, i.position));
#if HAS_UNLIT
    if (m.is_unlit && !is_back) {
        p.radiance += limited(p.throughput * m.inputs.base_color.rgb, p.depth);
        write_path(p, ENDED);
        return;
    }
#endif
    meet_emission(p, i, m, wo);
    if (is_back || p.depth >= u_bounces) {
        write_path(p, ENDED);
        return;
    }

    mat3 frame = mat3(i.t, i.b, i.n);
    vec3 local_wo = wo * frame;
    Standard lobe = standard_of(m);
    StandardView view = standard_view(lobe, local_wo.z, u_dfg);
#if HAS_LIGHTS
    LightSample light = sample_light(i.position, for_light.xyz);
    if (dot(light.direction, i.n_geometric) > 0.0) {
        vec3 local_wi = light.direction * frame;
        vec4 f = standard_eval_pdf(lobe, view, local_wo, local_wi, u_dfg);
        connect(p, i.position, i.n_geometric, light, f.rgb * local_wi.z, f.w);
    }
#endif
    BsdfSample b = standard_sample_view(lobe, view, local_wo, for_bsdf.xyz, u_dfg);
    vec3 wi = normalize(frame * b.wi);
    bool is_delta = (b.flags & DELTA) != 0u;
    bool goes = b.flags != 0u && dot(wi, i.n_geometric) > 0.0
             && scatter(p, i.position, i.n_geometric, wi, b.weight, is_delta ? 0.0 : b.pdf, for_bsdf.w);
    write_path(p, goes ? IN_FLIGHT : ENDED);
}
