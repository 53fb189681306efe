// Paths begin at a surface that emissive triangles light. A shadow ray goes to one of these, weighted against paths that
// hit one: few would find small ones.
#define LIT 1
#include "trace/bounce.glsl"
#include "trace/surface_ray.glsl"

void light_receiver(inout Path p, RayPoint at, Sample s) {
    p.pdf = surface_ray_pdf(at, p.direction);
    vec3 n = vec3(0.0);
#if HAS_LIGHT_TREE
    p.facing = pack_facing(at.n_geometric);
    n = unpack_facing(p.facing);
#endif
    LightSample light = sample_finite_light(at.position, n, sample_numbers(s, 1u + LIGHT_GROUP).xyz);
    if (light.is_delta || dot(light.direction, at.n_geometric) <= 0.0) return;
    float pdf = surface_ray_pdf(at, light.direction), share = 1.0;
#if HAS_ENVIRONMENT
    share -= u_environment_share; // of samples that light.pdf counts; here it has none of the others
#endif
    send_shadow_ray(p, at.position, at.n_geometric, p.medium, light, vec3(pdf * share), pdf);
}

#include "trace/generate.glsl"
