// Samples directions about the normal z from uniform random numbers u in [0, 1)^2. Densities are per solid angle.
#include "bsdf/constants.glsl"

// A uniform point in the unit disk, by the area-preserving and continuous concentric mapping: Shirley & Chiu 1997,
// "A Low Distortion Map Between Disk and Square"
vec2 sample_disk(vec2 u) {
    vec2 p = 2.0 * u - 1.0;
    bool x_dominates = abs(p.x) > abs(p.y);
    float r = x_dominates ? p.x : p.y;
    if (r == 0.0) return vec2(0.0);
    float phi = x_dominates ? 0.25 * PI * (p.y / p.x) : 0.5 * PI - 0.25 * PI * (p.x / p.y);
    return r * vec2(cos(phi), sin(phi));
}

// Density cos / pi: points of the disk are projected up to the hemisphere (Malley's method; Pharr et al., "PBRT",
// section A.5.3).
vec3 sample_cosine_hemisphere(vec2 u) {
    vec2 p = sample_disk(u);
    return vec3(p, sqrt(max(1.0 - dot(p, p), 0.0)));
}

// Density 1 / 2 pi: points of the disk, lifted by an area-preserving map (Archimedes' theorem of the hat box)
vec3 sample_uniform_hemisphere(vec2 u) {
    vec2 p = sample_disk(u);
    float r2 = dot(p, p);
    return vec3(p * sqrt(max(2.0 - r2, 0.0)), max(1.0 - r2, 0.0));
}

float pdf_cosine_hemisphere(vec3 w) {
    return max(w.z, 0.0) * INV_PI;
}
