// Free distances and transmittance in volumes, by collisions with a medium that is made homogeneous in each cell: as
// dense as the cell's majorant everywhere. A collision at a point where the density is lower is real with the
// probability density / majorant (Woodcock et al. 1965). Volumes that overlap are independent of one another: the first
// of their collisions counts, and their transmittances multiply.
//
// The extinction is the same in every channel, so that no weight arises; the albedo need not be.
#include "media/grid.glsl"
#include "media/no_collision.glsl"
#include "media/one_minus_exp.glsl"

// The most collisions of a walk, real or not. A walk that has more ends as if nothing more came; it is counted.
const int MAX_COLLISIONS = 65536;

// Walks that went wrong: densities above the majorant, and walks that were cut. There are none.
int tracking_faults = 0;
// The extinction of all volumes over that of their records (trace/endless.glsl)
float extinction_scale = 1.0;

Volume volume_met(int k) {
    Volume v = volume_at(k);
    v.extinction *= extinction_scale;
    return v;
}

// The density where a walk has a collision with the majorant: of a random voxel about it
float collision_density(Walk w, Volume v, inout uint counter) {
    float density = random_density_at(v, point_of(w), random_number(counter));
    tracking_faults += int(density > w.majorant);
    return density;
}

// The distance to the first collision before `limit`, or NO_COLLISION. u in [0, 1) is for the first optical depth.
float volume_collision(Volume v, vec3 origin, vec3 direction, float limit, float u, inout uint counter) {
    Walk w;
    if (!enter(v, origin, direction, limit, w)) return NO_COLLISION;
    for (int k = 0; k < MAX_COLLISIONS; ++k) {
        if (!advance(w, v, minus_log_one_minus(u))) return NO_COLLISION;
        float density = collision_density(w, v, counter);
        if (random_number(counter) * w.majorant < density) return w.start + w.t;
        u = random_number(counter);
    }
    ++tracking_faults;
    return NO_COLLISION;
}

// An estimate of the transmittance up to the distance `limit`, by ratio tracking: each collision with the majorant
// weighs by the probability that it is not real (Novak et al. 2014). Below 0.1 Russian roulette ends the walk.
float volume_transmittance(Volume v, vec3 origin, vec3 direction, float limit, inout uint counter) {
    Walk w;
    float transmittance = 1.0;
    if (!enter(v, origin, direction, limit, w)) return transmittance;
    for (int k = 0; k < MAX_COLLISIONS; ++k) {
        if (!advance(w, v, minus_log_one_minus(random_number(counter)))) return transmittance;
        transmittance *= max(1.0 - collision_density(w, v, counter) / w.majorant, 0.0);
        if (transmittance < 0.1) {
            if (random_number(counter) >= transmittance) return 0.0;
            transmittance = 1.0;
        }
    }
    ++tracking_faults;
    return 0.0;
}

// The distance to the first collision in any volume before `limit`, or NO_COLLISION; the number of that volume
float volumes_collision(vec3 origin, vec3 direction, float limit, float u, inout uint counter, out int volume) {
    float first = NO_COLLISION;
    volume = 0;
    int k = 0;
    do { // where its condition comes first, llvmpipe runs a loop's body once more
        float t = volume_collision(volume_met(k), origin, direction, min(limit, first), u, counter);
        if (t < first) volume = k;
        first = min(first, t);
        u = random_number(counter);
    } while (++k < u_volume_count);
    return first;
}

float volumes_transmittance(vec3 origin, vec3 direction, float limit, inout uint counter) {
    float transmittance = 1.0;
    int k = 0;
    do {
        transmittance *= volume_transmittance(volume_met(k), origin, direction, limit, counter);
    } while (++k < u_volume_count && transmittance > 0.0);
    return transmittance;
}
