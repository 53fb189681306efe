// How far light travels in a homogeneous medium. The extinction sigma_t may differ between the channels: a channel is
// chosen with the probabilities `chances`, whose sum is 1, and the weights divide by the mean density over all of them,
// so that no channel's distances have large weights in another (the one-sample model of Veach & Guibas 1995).
#include "media/one_minus_exp.glsl"

// Channels chosen by what they add to the picture, and never one that adds nothing.
vec3 channel_chances(vec3 throughput) {
    float sum = throughput.r + throughput.g + throughput.b;
    return sum > 0.0 ? throughput / sum : vec3(1.0 / 3.0);
}

// exp(-sigma_t t), times a factor that makes it 1 for the thinnest channel among those that can be chosen. So ratios of
// transmittances stay exact at any depth, where exp(-sigma_t t) itself is 0. The channels that cannot be chosen have no
// light; a bound on their factor keeps it finite.
vec3 scaled_transmittance(vec3 sigma_t, vec3 chances, float distance) {
    vec3 chosen = mix(vec3(3e38), sigma_t, greaterThan(chances, vec3(0.0)));
    float least = min(chosen.r, min(chosen.g, chosen.b));
    return exp(min((least - sigma_t) * distance, vec3(60.0)));
}

// The distance to the next collision, with the density sum of chances sigma_t exp(-sigma_t t); u in [0, 1)
float free_distance(vec3 sigma_t, vec3 chances, float u) {
    int channel = u < chances.r ? 0 : u < chances.r + chances.g || chances.b <= 0.0 ? 1 : 2;
    float below = channel == 0 ? 0.0 : channel == 1 ? chances.r : chances.r + chances.g;
    float u_channel = clamp((u - below) / chances[channel], 0.0, 1.0 - 1.0 / 16777216.0);
    return sigma_t[channel] > 0.0 ? minus_log_one_minus(u_channel) / sigma_t[channel] : 3e38;
}

// sigma_t exp(-sigma_t t) over the density: the weight of a path that collides at that distance, without the albedo
vec3 collision_weight(vec3 sigma_t, vec3 chances, float distance) {
    vec3 f = sigma_t * scaled_transmittance(sigma_t, chances, distance);
    return f / max(dot(chances, f), 1e-37);
}

// exp(-sigma_t t) over the probability of no collision before: the weight of a path that gets past that distance.
vec3 passing_weight(vec3 sigma_t, vec3 chances, float distance) {
    vec3 transmittance = scaled_transmittance(sigma_t, chances, distance);
    return transmittance / dot(chances, transmittance);
}

// A collision before the distance `limit`, of one channel: its density is sigma_t exp(-sigma_t t) / (1 - exp(-tau)).
float bounded_distance(float sigma_t, float limit, float u) {
    float tau = sigma_t * limit;
    return tau > 1e-30 ? min(minus_log_one_minus(u * one_minus_exp(tau)) / sigma_t, limit) : u * limit;
}

float bounded_distance_pdf(float sigma_t, float limit, float distance) {
    float tau = sigma_t * limit;
    return tau > 1e-30 ? sigma_t * exp(-sigma_t * distance) / one_minus_exp(tau) : 1.0 / limit;
}
