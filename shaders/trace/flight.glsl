// The flight of a path through its medium: where it collides, and what its throughput becomes if it does or does not.
// Distances follow the mean density over the channels, chosen by the throughput: then the sum of the throughputs stays
// the same at every step, but for absorption, so that no weight of a long path grows. (The product of these densities
// is the balance heuristic over whole paths of Miller, Georgiev & Jarosz 2019, "A Null-Scattering Path Integral
// Formulation of Light Transport", with one channel for each.)
#include "trace/state.glsl"
#include "media/medium.glsl"
#if HAS_SCATTERING
#include "trace/endless.glsl"
#include "trace/numbers.glsl"
#include "media/distance.glsl"

// The way that the path has in its medium: to its hit, or to the end of all media
float way_of(Path p) {
    return p.reach >= 0.0 ? p.reach : leaves_media(p.origin, p.direction);
}

// The distance to the next collision, if nothing is hit before; u is the first number of FLIGHT_GROUP.
float flight_of(Path p, Medium m, float u) {
    float way = free_distance(m.sigma_t, channel_chances(p.throughput), u);
    return distance_in(innermost(p.medium), p.origin, p.direction, way);
}
#endif

// Takes a path through its medium, over a distance in which it does not collide.
void pass_medium(inout Path p, float distance) {
#if HAS_SCATTERING
    int medium = innermost(p.medium);
    Medium m = medium_around(p);
    distance = length_in(medium, p.origin, p.direction, 0.0, distance);
    p.throughput *= scatters(m) ? passing_weight(m.sigma_t, channel_chances(p.throughput), distance)
                                : exp(-m.sigma_t * distance);
#else
    p.throughput *= transmittance(number_of(p.medium), distance);
#endif
}
