// The random numbers of a path's sample: four for each group of decisions.
#include "sample/sobol.glsl"
#include "trace/state.glsl"

uniform uint u_seed;

struct Sample {
    ivec2 pixel; // from the picture's lower left corner
    uint index;
};

// The sample that the path in `texel` of the present state works on, after which `left` samples remain.
Sample path_sample(ivec2 texel, int left) {
    ivec2 home = home_of(texel);
    ivec4 block = texelFetch(u_blocks, home / TILE, 0);
    return Sample(block.xy * TILE + home % TILE, uint(block.z + block.w - 1 - left));
}

vec4 sample_numbers(Sample s, uint group) {
    // The samples of a film's second part (viewer/trace/paths/wavefront.py) are a sequence of their own: the errors of
    // two stretches of one sequence are opposite.
    uint seed = u_seed ^ (s.index >> 23u) * 0x9E3779B9u;
    return sobol_owen(s.index & 0x7FFFFFu, hash(uint(s.pixel.x) | uint(s.pixel.y) << 16u, seed, group));
}

const uint CAMERA_GROUP = 0u;
const uint EMISSION_GROUP = 0xffffffffu, EMISSION_DISK_GROUP = 0xfffffffeu; // of photons, beyond all groups of vertices

// The groups of decisions at a surface; and on the way to it, through a medium
const uint BSDF_GROUP = 0u, LIGHT_GROUP = 1u, FLIGHT_GROUP = 2u, AIRLIGHT_GROUP = 3u;
const uint GROUP_BITS = HAS_SCATTERING == 1 ? 2u : 1u;

uint vertex_group(Path p, uint group) {
    return 1u + (uint(p.depth << STEP_BITS | p.steps) << GROUP_BITS | group);
}

vec4 vertex_numbers(Sample s, Path p, uint group) {
    return sample_numbers(s, vertex_group(p, group));
}

#if HAS_GRIDS
// The counter of a loop's random numbers (sample/random.glsl)
uint vertex_hash(Sample s, Path p, uint group) {
    return hash(hash(uint(s.pixel.x) | uint(s.pixel.y) << 16u, u_seed, vertex_group(p, group)), s.index);
}
#endif
