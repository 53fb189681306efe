// The emission of a surface as it leaves through its clear coat.
#include "trace/material.glsl"
#if CLEARCOAT
#include "bsdf/layer/coat.glsl"
#endif

uniform sampler2D u_dfg;

// `emission` towards wo, seen through the coat. Light that is hit and light that is sampled have to be the same.
vec3 through_coat(vec3 emission, Interaction i, MaterialInputs m, vec3 wo) {
#if CLEARCOAT
    float alpha = m.clearcoat_roughness * m.clearcoat_roughness;
    return make_coat(m.clearcoat, alpha, i.n_coat, max(dot(i.n_coat, wo), 0.0), u_dfg).throughput * emission;
#else
    return emission;
#endif
}

// The emission at a sampled point of an emitter towards wo, on the emitting side
vec3 emission_towards(Hit hit, vec3 wo) {
    vec3 emission = emission_at(hit);
#if CLEARCOAT
    if (clearcoat_factor(find_triangle(hit).material) > 0.0) {
        Interaction i = interact(hit, wo);
        emission = through_coat(emission, i, read_inputs(i.material, i.color, i.uv0, i.uv1), wo);
    }
#endif
    return emission;
}
