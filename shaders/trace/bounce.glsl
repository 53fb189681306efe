// What every kind of surface does with a path: it arrives, meets emission, sends a shadow ray to a light, and goes on.
#include "trace/numbers.glsl"
#include "trace/write_state.glsl"
#include "trace/limit.glsl"
#include "trace/mis.glsl"
#include "trace/material.glsl"
#include "media/medium.glsl"
#if HAS_LIGHTS
#include "trace/lights.glsl"
#endif

uniform int u_bounces; // the most often a path is scattered

// Whether the ray goes straight on: where alpha leaves the surface open, and for the camera at a back that is not there.
bool goes_on(Path p, Interaction i, SurfaceMaterial m, bool is_back, float u) {
#if HAS_SEE_THROUGH
    if (u >= m.coverage) return true;
#endif
    return is_back && p.depth == 0;
}

void pass_through(inout Path p, Interaction i) {
    p.travelled += distance(p.origin, i.position);
    p.origin = offset_origin(i.position, -i.n_geometric);
    ++p.passed;
}

// The surface's own light, as a direction that the BSDF chose (or the camera's) finds it
void meet_emission(inout Path p, Interaction i, SurfaceMaterial m, vec3 wo) {
#if HAS_EMISSION
    float weight = 1.0;
#if HAS_EMITTERS
    if (p.pdf > 0.0 && i.emitter >= 0) {
        float way = p.travelled + distance(p.origin, i.position);
        weight = bsdf_weight(p.pdf, emitter_pdf(i.emitter, i.area, way, dot(i.n_geometric, wo)));
    }
#endif
    p.radiance += limited(p.throughput * m.emission * weight, p.depth);
#endif
}

#if HAS_LIGHTS
// Sends a shadow ray. n is the geometric normal on the light's side and medium what lies there, f_cos the BSDF with
// the cosine and pdf that with which the BSDF's own sampling takes this direction.
void connect(inout Path p, vec3 position, vec3 n, int medium, LightSample light, vec3 f_cos, float pdf) {
    if (light.pdf <= 0.0) return;
    float weight = light.is_delta ? 1.0 : light_weight(light.pdf, pdf);
    vec3 carried = p.throughput * f_cos * light.radiance * transmittance(medium, light.distance);
    p.contribution = limited(carried * (weight / light.pdf), p.depth + 1);
    if (p.contribution == vec3(0.0)) return;
    p.shadow_origin = offset_origin(position, n);
    p.shadow_vector = position + light.direction * light.distance - p.shadow_origin;
}
#endif

// Goes on in the direction wi, n being the geometric normal on its side; pdf 0 where no other was possible. False if
// the path ends by Russian roulette (Arvo & Kirk 1990): u decides, and those that stay carry what was due to the others.
// eta2 undoes the squeezing of radiance inside glass, which is given back on the way out.
bool scatter(inout Path p, vec3 position, vec3 n, vec3 wi, vec3 weight, float pdf, float u) {
    p.throughput *= weight;
    float survival = max(p.throughput.r, max(p.throughput.g, p.throughput.b)) * p.eta2;
    if (!(survival > 0.0)) return false;
    if (p.depth >= 3) {
        survival = min(survival, 0.95);
        if (u >= survival) return false;
        p.throughput /= survival;
    }
    ++p.depth;
    p.origin = offset_origin(position, n);
    p.direction = wi;
    p.pdf = pdf;
    p.travelled = 0.0;
    return true;
}
