// Curves: fibres that scatter light by the model of bsdf/fibre/fibre.glsl. They do not emit.
// PHOTONS: paths from lights end here. The model asks for the light from all sides at the place that the camera sees; a
// photon comes to one place only, and most of its light leaves at others.
#include "trace/bounce.glsl"
#include "trace/write_state.glsl"
#include "trace/fibre_hit.glsl"

void main() {
    ivec2 texel = source_of(ivec2(gl_FragCoord.xy));
    uvec4 hit = texelFetch(u_hit, texel, 0);
    Path p = read_path(texel, hit);
#if PHOTONS
    write_path(p, ENDED);
#else
    Sample s = path_sample(texel, p.left);
    vec4 u_light = vertex_numbers(s, p, LIGHT_GROUP), u_bsdf = vertex_numbers(s, p, BSDF_GROUP);
    FibreHit i = fibre_hit(unpack_hit(hit), p.origin, p.direction);
#if HAS_SCATTERING
    pass_medium(p, distance(p.origin, i.position));
#else
    pass_medium(p, p.travelled + distance(p.origin, i.position));
#endif
    if (p.depth >= u_bounces) {
        write_path(p, ENDED);
        return;
    }

    vec3 wo = -p.direction * i.frame;
    float h = fibre_offset(vec3(0.0, 0.0, 1.0), wo);
#if HAS_LIGHTS
#if HAS_LIGHT_TREE
    p.facing = 0.0;
#endif
    LightSample light = sample_light(i.position, vec3(0.0), u_light.xyz);
    vec3 wi_light = light.direction * i.frame;
    send_shadow_ray_from(p, i.position, leave_fibre(i, light.direction), p.medium, light,
                         fibre_eval(i.fibre, h, wo, wi_light), fibre_pdf(i.fibre, h, wo, wi_light));
#endif
    vec3 wi;
    float pdf;
    vec3 weight = fibre_sample(i.fibre, h, wo, u_bsdf, wi, pdf);
    wi = normalize(i.frame * wi);
    // No weight is above 1, so that all light which white hair scatters hundreds of times may stay on one path.
    bool continues = pdf > 0.0 && scatter(p, i.position, i.n, wi, weight, pdf, u_light.w, 1.0, 1.0);
    p.origin = leave_fibre(i, wi);
    write_path(p, continues ? IN_FLIGHT : ENDED);
#endif
}
