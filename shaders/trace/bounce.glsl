// The steps of a path at a surface that are the same for all kinds of surfaces: emission, the shadow ray to a light,
// and the next direction with Russian roulette.
#include "trace/numbers.glsl"
#include "trace/clamp.glsl"
#include "trace/mis.glsl"
#include "trace/emission.glsl"
#include "trace/flight.glsl"
#if HAS_LIGHTS
#include "trace/lights.glsl"
#endif

uniform int u_bounces; // the largest number of times that a path is scattered

// Whether the ray continues straight through the surface. It does so with probability 1 - coverage. A camera ray also
// does so where it hits the back of a single-sided surface.
bool continues_straight(Path p, SurfaceMaterial m, bool is_back, float u) {
#if HAS_SEE_THROUGH
    if (u >= m.coverage) return true;
#endif
    return is_back && p.depth == 0;
}

#if HAS_SEE_THROUGH
// The random number that decides it. One number serves all surfaces that a path continues straight through, so that it
// is spread evenly over the samples whether it passes one or many: what decided is taken off it at each of them.
float number_of_coverage(Path p, float fresh) {
    return p.kept > 0.0 ? p.kept : fresh;
}

float left_of(float u, float coverage) {
    return u < coverage ? u / coverage : (u - coverage) / (1.0 - coverage);
}
#endif

void continue_straight(inout Path p, Interaction i) {
    float way = distance(p.origin, i.position);
#if HAS_SCATTERING
    pass_medium(p, way);
    p.is_lit = false;
#endif
    p.travelled += way;
    p.origin = offset_origin(i.position, -i.n_geometric);
    ++p.steps;
}

// Adds the emission of a surface that was hit by a BSDF sample or by a camera ray.
void add_emission(inout Path p, Interaction i, SurfaceMaterial m, vec3 wo) {
#if HAS_EMISSION
    float weight = 1.0;
#if HAS_EMITTERS
    if (p.pdf > 0.0 && i.emitter >= 0) {
        float path_length = p.travelled + distance(p.origin, i.position);
        vec3 from = p.origin - p.travelled * p.direction;
        float light_pdf = emitter_pdf(i.emitter, i.area, from, facing_of(p), path_length, dot(i.n_geometric, wo));
        weight = bsdf_weight(p.pdf, light_pdf);
    }
#endif
    p.radiance += clamped(p.throughput * through_coat(m.emission, i, m.inputs, wo) * weight, p.depth);
#endif
}

#if HAS_LIGHTS
// `pdf` is that with which BSDF sampling would choose the direction.
float weight_of(LightSample light, float pdf) {
    return light.is_delta ? 1.0 : light_weight(light.pdf, pdf);
}

// Prepares a shadow ray to a light sample. `medium` is the medium on the light's side, or the nesting of media. `f_cos`
// is the BSDF times the cosine. `pdf` is the density with which BSDF sampling would choose this direction. `origin` is
// where the ray begins.
void send_shadow_ray_from(inout Path p, vec3 position, vec3 origin, int medium, LightSample light, vec3 f_cos,
                          float pdf) {
    if (light.pdf <= 0.0) return;
    float weight = weight_of(light, pdf);
    vec3 radiance = p.throughput * f_cos * light.radiance;
#if HAS_SCATTERING
    p.shadow_medium = medium; // the shadow ray finds what is on its way
#else
    radiance *= transmittance(number_of(medium), light.distance);
#endif
    p.contribution = clamped(radiance * (weight / light.pdf), p.depth + 1);
    if (p.contribution == vec3(0.0)) return;
    p.shadow_origin = origin;
    p.shadow_vector = position + light.direction * light.distance - p.shadow_origin;
}

// From a surface with the geometric normal `n` on the light's side
void send_shadow_ray(inout Path p, vec3 position, vec3 n, int medium, LightSample light, vec3 f_cos, float pdf) {
    send_shadow_ray_from(p, position, offset_origin(position, n), medium, light, f_cos, pdf);
}
#endif

const float ENDURES = 0.5; // throughput from which on paths do not end; benchmarks/results/trace_variance.md

// Continues the path in the direction wi. `n` is the geometric normal on the side of wi. `pdf` is 0 where wi was the
// only possible direction. `most` is the greatest probability to survive. Returns false if the path ends by Russian
// roulette (Arvo & Kirk 1990): if u is below the probability `survival`, the path survives and its throughput is
// divided by that probability.
// Paths end where they carry less than ENDURES: to end more of them saves less time than their light is missed. `worth`
// is what a path may bring for what it carries, of others: more than 1 if a guide sent it where much light comes from.
// Radiance inside glass is scaled by eta^2 until it leaves the glass; p.eta2 takes that factor out of the probability.
bool scatter(inout Path p, vec3 position, vec3 n, vec3 wi, vec3 weight, float pdf, float u, float most,
             float worth) {
    p.throughput *= weight;
    float survival = max(p.throughput.r, max(p.throughput.g, p.throughput.b)) * p.eta2 * worth;
    if (!(survival > 0.0)) return false;
    if (p.depth >= (PHOTONS == 1 ? 3 : 2)) { // of photons, mirrors show what comes later
        survival = min(survival / ENDURES, most);
        if (u >= survival) return false;
        p.throughput /= survival;
    }
    ++p.depth;
    p.origin = offset_origin(position, n);
    p.direction = wi;
    p.pdf = pdf;
    p.travelled = 0.0;
#if HAS_SCATTERING
    p.is_lit = false;
#endif
    return true;
}
