// Whether a shadow ray passes a see-through triangle, which it does with probability 1 - coverage.
#include "trace/material.glsl"

// PCG4D, M. Jarzynski, M. Olano: Hash Functions for GPU Rendering, JCGT 9(3), 2020.
uvec4 pcg4d(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// The random number depends only on the ray, whose `vector` differs from sample to sample, and on the triangle. So the
// decision is the same in whatever order, and however often, the triangles of a ray are tested.
bool shadow_ray_passes(Hit hit, vec3 vector) {
    uvec4 seed = pcg4d(uvec4(floatBitsToUint(vector), uint(hit.instance)));
    uint random = pcg4d(seed ^ uvec4(uint(hit.triangle))).x;
    return float(random >> 8u) * (1.0 / 16777216.0) >= coverage_at(hit);
}
