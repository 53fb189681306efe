// A path collides in its medium: sends a shadow ray to a light and samples the direction in which it is scattered.
// PHOTONS: the path comes from a light, and its shadow ray goes to the camera.
#include "trace/bounce.glsl"
#include "trace/write_state.glsl"
#include "media/any_phase.glsl"
#if HAS_CLEARANCE
#include "media/clearance.glsl"
#endif
#if PHOTONS
#include "trace/connect.glsl"
#endif
#if HAS_DEEP_MEDIA
#include "media/deep_walk.glsl"
#endif
#if HAS_GRIDS
#include "media/volume_medium.glsl"
#include "trace/volume_flight.glsl"
#endif

const int MOST_AT_ONCE = 32; // collisions of a path in one pass

// Samples the direction in which a path that has collided goes on; `asked`: it has asked a light there. Returns false
// if it ends there.
bool scatter_in(inout Path p, Medium m, bool asked, vec3 u) {
    vec3 direction = any_phase_sample(m.phase, p.direction, u.xy);
#if PHOTONS
    p.pdf = FROM_ROUGH;
#else
    // Where no light is asked, light that is hit counts in full.
    p.pdf = asked ? any_phase(m.phase, p.direction, direction) : 0.0;
#endif
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
    p.travelled = 0.0;
    p.is_lit = false;
    ++p.steps;
    if (p.depth < 2) ++p.depth; // indirect light has at least 2; `bounces` does not count collisions
    return continues;
}

void main() {
    ivec2 texel = source_of(ivec2(gl_FragCoord.xy));
    Path p = read_path(texel, uvec4(0u));
    Sample s = path_sample(texel, p.left);
    Medium m = medium_around(p);
    vec4 u = vertex_numbers(s, p, FLIGHT_GROUP);
    float way = scatters(m) ? flight_of(p, m, u.x) : 3e38;
    bool is_in_grid = false;
#if HAS_GRIDS
    vec4 flight = texelFetch(u_flight, texel, 0);
    is_in_grid = flight.x < way;
    if (is_in_grid) {
        way = flight.x;
        pass_medium(p, way);
        m = volume_medium(int(flight.y));
#if !PHOTONS
        p.radiance += clamped(p.throughput * volume_emission(int(flight.y)) * collisions_each(p), p.depth);
#endif
        p.throughput *= albedo_left(m.albedo, p);
    }
#endif
    // Shadow rays go through fog and solids as dense as they are, and paths after very many collisions do not.
    bool asks = asks_lights(m) && (is_in_grid || p.steps < THINS_FROM);
    if (!is_in_grid) p.throughput *= m.albedo * collision_weight(m.sigma_t, channel_chances(p.throughput), way);
    p.origin += way * p.direction;
#if HAS_LIGHT_TREE
    p.facing = 0.0;
#endif

#if PHOTONS
    p.radiance = vec3(0.0);
    if (p.depth == 0) { // paths from the camera find light that comes straight from a lamp
        write_path(p, ENDED);
        return;
    }
    CameraSample c = sample_camera(p.origin);
    connect_camera(p, p.origin, p.origin, c, p.medium, p.throughput * any_phase(m.phase, p.direction, c.direction));
#elif HAS_ENVIRONMENT || HAS_EMITTERS || HAS_PUNCTUAL && HAS_GRIDS
    if (asks) {
        LightSample light = sample_light(p.origin, vec3(0.0), vertex_numbers(s, p, LIGHT_GROUP).xyz);
        if (light.is_delta && !is_in_grid) light.pdf = 0.0; // trace/airlight.frag has counted it
        float phase = any_phase(m.phase, p.direction, light.direction);
        send_shadow_ray(p, p.origin, vec3(0.0), p.medium, light, vec3(phase), phase);
    }
#endif
    // In media where no light is asked, all numbers of a collision are of one group.
    bool continues = scatter_in(p, m, asks, asks ? vertex_numbers(s, p, BSDF_GROUP).xyz : u.yzw);
#if HAS_DEEP_MEDIA
    if (continues && !is_in_grid) walk_deep(p, s);
#endif
#if HAS_CLEARANCE
    // Where no light is asked, the next collisions need no rays as long as no surface is near.
    for (int k = 1; k < MOST_AT_ONCE && continues && !asks_lights(m); ++k) {
        u = vertex_numbers(s, p, FLIGHT_GROUP);
        m = medium_around(p);
        way = flight_of(p, m, u.x);
        if (!is_clear(p.origin, p.direction, way)) break;
        p.throughput *= m.albedo * collision_weight(m.sigma_t, channel_chances(p.throughput), way);
        p.origin += way * p.direction;
        continues = scatter_in(p, m, false, u.yzw);
#if HAS_DEEP_MEDIA
        if (continues) walk_deep(p, s);
#endif
    }
#endif
    write_path(p, continues ? IN_FLIGHT : ENDED);
}
