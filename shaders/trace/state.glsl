// The state of a wave's paths, a texel a slot, and how it is packed (viewer/trace/paths/wavefront.py has the textures).
#include "trace/hit.glsl"

uniform sampler2D u_origin;        // xyz, status: IDLE, IN_FLIGHT or ENDED
uniform sampler2D u_direction;     // unit, pdf of the BSDF's sample by solid angle; 0: light met counts in full
uniform sampler2D u_shadow_origin; // of the pending shadow ray, or else x: travelled; contribution.r
uniform sampler2D u_shadow_vector; // to the light, 0: there is none; contribution.g
uniform sampler2D u_throughput;    // rgb; contribution.b
uniform sampler2D u_radiance;      // of the path so far; counters
#if HAS_TRANSMISSION
uniform sampler2D u_medium;        // number; reserved: distance to the next collision, wavelength; product of eta^2
#endif
uniform usampler2D u_hit;          // see trace/hit.glsl
uniform isampler2D u_blocks;       // tile x, tile y, first sample, samples; a texel for TILE x TILE slots

struct Path {
    vec3 origin;
    vec3 direction;
    float pdf;
    float travelled;    // from the path's last vertex to the origin: it may have gone straight through surfaces
    vec3 throughput;
    vec3 radiance;
    int depth;          // how often it was scattered
    int passed;         // surfaces it went straight through, modulo 64
    int left;           // samples of the slot after this one
    int medium;         // number of what it goes through (media/medium.glsl)
    float eta2;         // product of eta^2: by how much radiance is squeezed there
    vec3 shadow_origin; // of the shadow ray to be sent, of no length where there is none
    vec3 shadow_vector;
    vec3 contribution;  // what that adds if it is free
};

// depth < 2^8, passed < 2^6, left < 2^10: whole numbers below 2^24 are exact
float pack_counters(int depth, int passed, int left) {
    return float((depth << 6 | (passed & 63)) << 10 | left);
}

int unpack_depth(float counters) {
    return int(counters) >> 16;
}

int unpack_left(float counters) {
    return int(counters) & 1023;
}

// The path in a slot when its rays have come back: what its shadow ray carried is counted.
Path read_path(ivec2 slot, uvec4 hit) {
    vec4 origin = texelFetch(u_origin, slot, 0), direction = texelFetch(u_direction, slot, 0);
    vec4 a = texelFetch(u_shadow_origin, slot, 0), b = texelFetch(u_shadow_vector, slot, 0);
    vec4 throughput = texelFetch(u_throughput, slot, 0), radiance = texelFetch(u_radiance, slot, 0);
    Path p;
    p.origin = origin.xyz;
    p.direction = direction.xyz;
    p.pdf = direction.w;
    p.throughput = throughput.rgb;
    bool has_shadow_ray = b.xyz != vec3(0.0);
    p.radiance = radiance.rgb + (has_shadow_ray && is_shadow_ray_free(hit) ? vec3(a.w, b.w, throughput.w) : vec3(0.0));
    p.travelled = has_shadow_ray ? 0.0 : a.x;
    int counters = int(radiance.w);
    p.depth = counters >> 16;
    p.passed = counters >> 10 & 63;
    p.left = counters & 1023;
#if HAS_TRANSMISSION
    vec4 medium = texelFetch(u_medium, slot, 0);
    p.medium = int(medium.x);
    p.eta2 = medium.w;
#else
    p.medium = 0;
    p.eta2 = 1.0;
#endif
    p.shadow_origin = p.shadow_vector = p.contribution = vec3(0.0);
    return p;
}
