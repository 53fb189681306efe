// The state of a wavefront's paths, one texel of each texture for each path, and how it is packed.
// viewer/trace/paths/wavefront.py makes the textures.
#include "trace/hit.glsl"

uniform sampler2D u_origin;        // xyz, status: IDLE, IN_FLIGHT or ENDED
uniform sampler2D u_direction;     // unit vector; pdf of the BSDF sample by solid angle, 0: no MIS weight for light it hits
uniform sampler2D u_shadow_origin; // of the pending shadow ray, or x: travelled if there is none; contribution.r
uniform sampler2D u_shadow_vector; // to the light, 0: there is no shadow ray; contribution.g
uniform sampler2D u_throughput;    // rgb; contribution.b
uniform sampler2D u_radiance;      // that the path has gathered so far; counters
#if HAS_TRANSMISSION
uniform sampler2D u_medium;        // number; reserved: distance to the next collision; wavelength; product of eta^2
#endif
uniform usampler2D u_hit;          // see trace/hit.glsl
uniform isampler2D u_blocks;       // tile x, tile y, first sample, samples; a texel for each block of TILE x TILE paths

struct Path {
    vec3 origin;
    vec3 direction;
    float pdf;
    float travelled;    // distance from the path's last vertex to the origin, which differs from it after crossings
    vec3 throughput;
    vec3 radiance;
    int depth;          // number of scattering events
    int crossings;      // surfaces that it continued straight through, modulo 64
    int left;           // samples that remain after this one
    int medium;         // number of the medium that it travels in (media/medium.glsl)
#if DISPERSIVE
    float wavelength;   // in nm, 0 before the first dispersive surface
#endif
    float eta2;         // product of eta^2 over refractions: the factor of radiance inside glass
    vec3 shadow_origin;
    vec3 shadow_vector; // from there to the light, 0 if there is no shadow ray
    vec3 contribution;  // radiance that is added if the shadow ray is unoccluded
};

// depth < 2^8, crossings < 2^6, left < 2^10: whole numbers below 2^24 are exact in float32
float pack_counters(int depth, int crossings, int left) {
    return float((depth << 6 | (crossings & 63)) << 10 | left);
}

int unpack_depth(float counters) {
    return int(counters) >> 16;
}

int unpack_left(float counters) {
    return int(counters) & 1023;
}

// The path in a texel after its rays were traced. The contribution of an unoccluded shadow ray is in its radiance.
Path read_path(ivec2 texel, uvec4 hit) {
    vec4 origin = texelFetch(u_origin, texel, 0), direction = texelFetch(u_direction, texel, 0);
    vec4 a = texelFetch(u_shadow_origin, texel, 0), b = texelFetch(u_shadow_vector, texel, 0);
    vec4 throughput = texelFetch(u_throughput, texel, 0), radiance = texelFetch(u_radiance, texel, 0);
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
    p.crossings = counters >> 10 & 63;
    p.left = counters & 1023;
#if HAS_TRANSMISSION
    vec4 medium = texelFetch(u_medium, texel, 0);
    p.medium = int(medium.x);
    p.eta2 = medium.w;
#else
    p.medium = 0;
    p.eta2 = 1.0;
#endif
#if DISPERSIVE
    p.wavelength = medium.z;
#endif
    p.shadow_origin = p.shadow_vector = p.contribution = vec3(0.0);
    return p;
}
