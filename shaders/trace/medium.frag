// A path collides in its medium: sends a shadow ray to a light and samples the direction in which it is scattered.
#include "trace/bounce.glsl"
#include "trace/write_state.glsl"
#include "media/any_phase.glsl"
#if HAS_GRIDS
#include "media/volume_medium.glsl"
#include "trace/volume_flight.glsl"
#endif

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    Path p = read_path(texel, uvec4(0u));
    Sample s = path_sample(texel, p.left);
    Medium m = medium_of(innermost(p.medium));
    float way = scatters(m) ? flight_of(p, m, s) : 3e38;
    bool is_in_grid = false;
#if HAS_GRIDS
    vec4 flight = texelFetch(u_flight, texel, 0);
    is_in_grid = flight.x < way;
    if (is_in_grid) {
        way = flight.x;
        pass_medium(p, way);
        m = volume_medium(int(flight.y));
        p.radiance += clamped(p.throughput * volume_emission(int(flight.y)), p.depth);
        p.throughput *= m.albedo;
    }
#endif
    if (!is_in_grid) p.throughput *= m.albedo * collision_weight(m.sigma_t, channel_chances(p.throughput), way);
    p.origin += way * p.direction;

#if HAS_ENVIRONMENT || HAS_EMITTERS || HAS_PUNCTUAL && HAS_GRIDS
    if (asks_lights(m)) {
        LightSample light = sample_light(p.origin, vertex_numbers(s, p, LIGHT_GROUP).xyz);
        if (light.is_delta && !is_in_grid) light.pdf = 0.0; // trace/airlight.frag has counted it
        float phase = any_phase(m.phase, p.direction, light.direction);
        send_shadow_ray(p, p.origin, vec3(0.0), p.medium, light, vec3(phase), phase);
    }
#endif
    vec4 u = vertex_numbers(s, p, BSDF_GROUP);
    vec3 direction = any_phase_sample(m.phase, p.direction, u.xy);
    // Where no light is asked, light that is hit counts in full.
    float pdf = asks_lights(m) ? any_phase(m.phase, p.direction, direction) : 0.0;
    // Roulette alone ends paths, with the probability that they are absorbed; a white medium keeps them all.
    float survival = min(max(p.throughput.r, max(p.throughput.g, p.throughput.b)) * p.eta2, 1.0);
    bool continues = u.z < survival;
    // A path that would not end spoils its sample, which is then left out of the picture and counted.
    if (continues && p.steps >= MOST_STEPS) {
        continues = false;
        p.radiance = vec3(uintBitsToFloat(0x7fc00000u));
    }
    p.throughput /= max(survival, 1e-30);
    p.direction = direction;
    p.pdf = pdf;
    p.travelled = 0.0;
    p.is_lit = false;
    ++p.steps;
    if (p.depth < 2) ++p.depth; // indirect light has at least 2; `bounces` does not count collisions
    write_path(p, continues ? IN_FLIGHT : ENDED);
}
