// What a medium scatters towards the path from point, spot and directional lights, all the way to the hit: the path
// stays, and sends a shadow ray from one point of its ray. With this a path sees the light in thin fog without a
// collision there, and the singularity of a point light does no harm. The point is chosen by the mean of two densities:
// equiangular about the light, and as collisions before the hit are distributed.
#include "trace/bounce.glsl"
#include "trace/endless.glsl"
#include "trace/write_state.glsl"
#include "media/any_phase.glsl"
#include "media/equiangular.glsl"
#if HAS_GRIDS
#include "media/tracking.glsl"
#endif

// The density over a ray of length `way` of its points
float airlight_pdf(Medium m, vec3 chances, float way, float t) {
    return chances.r * bounded_distance_pdf(m.sigma_t.r, way, t) + chances.g * bounded_distance_pdf(m.sigma_t.g, way, t)
         + chances.b * bounded_distance_pdf(m.sigma_t.b, way, t);
}

float airlight_sample(Medium m, vec3 chances, float way, float u) {
    int channel = u < chances.r ? 0 : u < chances.r + chances.g || chances.b <= 0.0 ? 1 : 2;
    float below = channel == 0 ? 0.0 : channel == 1 ? chances.r : chances.r + chances.g;
    u = clamp((u - below) / max(chances[channel], 1e-30), 0.0, 1.0 - 1.0 / 16777216.0);
    return bounded_distance(m.sigma_t[channel], way, u);
}

void main() {
    ivec2 texel = source_of(ivec2(gl_FragCoord.xy));
    Path p = read_path(texel, uvec4(0u));
    int medium = innermost(p.medium);
    Medium m = medium_around(p);
    vec4 u = vertex_numbers(path_sample(texel, p.left), p, AIRLIGHT_GROUP);
    vec3 chances = channel_chances(p.throughput);
    float end = way_of(p), start = HAS_FOG > 0 ? min(media_span(p.origin, p.direction).x, end) : 0.0;
    float way = length_in(medium, p.origin, p.direction, 0.0, end);
    p.is_lit = true;
    p.shadow_medium = p.medium;
    if (HAS_FOG > 0 && way <= 0.0) { // outside of the fog
        write_path(p, IN_FLIGHT);
        return;
    }

    float chance; // of the light
    vec2 rest;
#if HAS_LIGHT_TREE
    int k = choose_punctual(Receiver(p.origin + start * p.direction, p.direction, end - start), u.xyz, chance, rest);
    if (k < 0) {
        write_path(p, IN_FLIGHT);
        return;
    }
#else
    int k = choose_punctual(u.xyz, chance, rest);
#endif
    vec4 light = scene_float4(u_punctual + 3 * k);
    bool has_place = light.w >= 0.0;
    // Chosen by angle or by length in the medium, a point has a density of both.
    Equiangular e = equiangular(p.origin + start * p.direction, p.direction, end - start, light.xyz);
    bool is_by_angle = has_place && u.w < 0.5;
    float t, length;
    if (is_by_angle) {
        t = start + equiangular_sample(e, end - start, 2.0 * u.w);
        length = length_in(medium, p.origin, p.direction, 0.0, t);
    } else {
        length = airlight_sample(m, chances, way, has_place ? 2.0 * u.w - 1.0 : u.w);
        t = min(distance_in(medium, p.origin, p.direction, length), end);
    }
    float density = density_in(medium, p.origin + t * p.direction);
    float pdf = density * airlight_pdf(m, chances, way, length);
    if (has_place) pdf = 0.5 * (equiangular_pdf(e, t - start) + pdf);
    vec3 position = p.origin + t * p.direction, l;
    float distance;
    vec3 irradiance = punctual_irradiance(k, position, rest, l, distance);
    vec3 scattered = m.albedo * m.sigma_t * density * exp(-m.sigma_t * length) * any_phase(m.phase, p.direction, l);
#if HAS_GRIDS
    uint counter = vertex_hash(path_sample(texel, p.left), p, AIRLIGHT_GROUP);
    extinction_scale = extinction_left(p);
    scattered *= volumes_transmittance(p.origin, p.direction, t, counter);
#endif
    // A point on the face of a box of a volume may count as inside, where there is no fog.
    if (pdf > 0.0) p.contribution = clamped(p.throughput * scattered * irradiance / (pdf * chance), p.depth + 1);
    if (p.contribution != vec3(0.0)) {
        p.shadow_origin = position;
        p.shadow_vector = distance * l;
    }
    write_path(p, IN_FLIGHT);
}
