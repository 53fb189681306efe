// The state of a wavefront's paths, one texel of each texture for each path, and how it is packed.
// viewer/trace/paths/wavefront.py makes the textures.
#include "trace/arrangement.glsl"
#include "trace/hit.glsl"
#if HAS_LIGHT_TREE
#include "trace/facing.glsl"
#endif

uniform sampler2D u_origin;        // xyz; the sign is the status, IDLE, IN_FLIGHT or ENDED, and in flight the value is
                                   // the pdf of the BSDF sample by solid angle, or NO_PDF
uniform sampler2D u_direction;     // unit vector; contribution.r of the pending shadow ray, or travelled if there is none
uniform sampler2D u_shadow_vector; // to the light, 0: there is no shadow ray; contribution.g, or kept
uniform sampler2D u_throughput;    // rgb; contribution.b
uniform sampler2D u_radiance;      // that the path has gathered so far; counters
uniform sampler2D u_shadow_origin; // of the shadow ray: u_origin where all rays from a vertex begin at one place; facing
#if HAS_TRANSMISSION
uniform sampler2D u_medium;        // number; if HAS_PANES, travelled; wavelength; product of eta^2
#endif
#if HAS_SCATTERING
// In scenes with scattering, u_medium has instead: the nesting of media (media/nesting.glsl); that of the shadow ray
// or, of a path that is_lit and whose shadow ray has the same, travelled; wavelength; product of eta^2, negative if
// is_lit. A path that has passed a pane, and whose shadow ray has the same, too, has -travelled.
#endif
#if HAS_SCATTERING || HAS_PANES
uniform sampler2D u_along;         // of the rays: transmittance of the shadow ray, 0 if occluded; distance to the hit
#endif
uniform usampler2D u_hit;          // see trace/hit.glsl
uniform isampler2D u_blocks;       // tile x, tile y, first sample, samples; a texel for each block of TILE x TILE paths

const float NO_PDF = 3e38; // as great as the pdf of a delta lobe

struct Path {
    vec3 origin;
    vec3 direction;
    float pdf;          // of the BSDF sample by solid angle, 0: no MIS weight for light that it hits
#if HAS_LIGHT_TREE
    float facing;       // of the path's last vertex (trace/facing.glsl)
#endif
    float travelled;    // distance from the path's last vertex to the origin, which differs from it after crossings
#if HAS_SEE_THROUGH
    float kept;         // what is left of the random number that let it through a surface, 0 if nothing is
#endif
    vec3 throughput;
    vec3 radiance;
    int depth;          // number of scattering events
    int steps;          // surfaces that it continued straight through, and collisions in media; modulo 2^STEP_BITS
    int left;           // samples that remain after this one
    int medium;         // number of the medium that it travels in (media/medium.glsl), or the nesting of media
#if DISPERSIVE
    float wavelength;   // in nm, 0 before the first dispersive surface
#endif
    float eta2;         // product of eta^2 over refractions: the factor of radiance inside glass
    vec3 shadow_origin;
    vec3 shadow_vector; // from there to the light, 0 if there is no shadow ray
    vec3 contribution;  // radiance that is added if the shadow ray is unoccluded
#if HAS_SCATTERING
    int shadow_medium;  // nesting of the media that the shadow ray starts in
    bool is_lit;        // light that is scattered on the way to the hit is counted already (trace/airlight.frag)
    float reach;        // distance to the hit, negative if there is none
#endif
};

// The normal of the path's last vertex on the side from which light may come, 0 where it may from all around
vec3 facing_of(Path p) {
#if HAS_LIGHT_TREE
    return unpack_facing(p.facing);
#else
    return vec3(0.0);
#endif
}

const int STEP_BITS = HAS_SCATTERING == 1 ? 13 : 6;

// depth < 2^8, left < 2^LEFT_BITS. With few steps the counters are a whole number below 2^24, which is exact in
// float32. With more they are the bits of a float: the exponent is seven bits of the depth and 1, so that it is never
// that of 0 or of infinity, and the sign is the eighth.
float pack_counters(int depth, int steps, int left) {
    int rest = (steps & ((1 << STEP_BITS) - 1)) << LEFT_BITS | left;
#if HAS_SCATTERING
    return intBitsToFloat((depth & 128) << 24 | ((depth & 127) + 1) << 23 | rest);
#else
    return float(depth << (STEP_BITS + LEFT_BITS) | rest);
#endif
}

// depth << (STEP_BITS + LEFT_BITS) | steps << LEFT_BITS | left
int unpack_counters(float counters) {
#if HAS_SCATTERING
    int bits = floatBitsToInt(counters);
    return (bits & 0x7fffffff) - (1 << 23) | (bits < 0 ? 1 << 30 : 0);
#else
    return int(counters);
#endif
}

int unpack_depth(float counters) {
    return unpack_counters(counters) >> (STEP_BITS + LEFT_BITS);
}

int unpack_left(float counters) {
    return unpack_counters(counters) & ((1 << LEFT_BITS) - 1);
}

// The path in a texel after its rays were traced. The contribution of an unoccluded shadow ray is in its radiance.
Path read_path(ivec2 texel, uvec4 hit) {
    vec4 origin = texelFetch(u_origin, texel, 0), direction = texelFetch(u_direction, texel, 0);
    vec4 shadow = texelFetch(u_shadow_vector, texel, 0);
    vec4 throughput = texelFetch(u_throughput, texel, 0), radiance = texelFetch(u_radiance, texel, 0);
    Path p;
    p.origin = origin.xyz;
    p.direction = direction.xyz;
    p.pdf = origin.w < NO_PDF ? origin.w : 0.0;
    p.throughput = throughput.rgb;
#if HAS_LIGHT_TREE
    p.facing = texelFetch(u_shadow_origin, texel, 0).w;
#endif
    bool has_shadow_ray = shadow.xyz != vec3(0.0);
    vec3 pending = vec3(direction.w, shadow.w, throughput.w);
    p.travelled = has_shadow_ray ? 0.0 : pending.x;
#if HAS_SEE_THROUGH
    p.kept = has_shadow_ray ? 0.0 : pending.y;
#endif
    int counters = unpack_counters(radiance.w);
    p.depth = counters >> (STEP_BITS + LEFT_BITS);
    p.steps = counters >> LEFT_BITS & ((1 << STEP_BITS) - 1);
    p.left = counters & ((1 << LEFT_BITS) - 1);
#if HAS_TRANSMISSION
    vec4 medium = texelFetch(u_medium, texel, 0);
    p.medium = int(medium.x);
    p.eta2 = medium.w;
#else
    p.medium = 0;
    p.eta2 = 1.0;
#endif
#if HAS_SCATTERING || HAS_PANES
    vec4 along = texelFetch(u_along, texel, 0);
    // Also without a shadow ray: NaN in u_along spoils the sample (trace/track.frag).
    p.radiance = radiance.rgb + along.rgb * (has_shadow_ray ? pending : vec3(0.0));
#endif
#if HAS_SCATTERING
    p.reach = along.w;
    p.is_lit = p.eta2 < 0.0;
    if (p.is_lit) p.travelled = medium.y;
#if HAS_PANES
    else if (medium.y < 0.0) p.travelled = -medium.y;
#endif
    p.eta2 = abs(p.eta2);
    // Without a surface ahead the path is outside of all solids. Rounding can take a collision beyond a solid's
    // surface, and a path from there would collide without end.
    if (p.reach < 0.0) p.medium = 0;
    p.shadow_medium = p.medium;
#elif HAS_PANES
    p.travelled = medium.y;
#else
    p.radiance = radiance.rgb + (has_shadow_ray && is_shadow_ray_free(hit) ? pending : vec3(0.0));
#endif
#if DISPERSIVE
    p.wavelength = medium.z;
#endif
    p.shadow_origin = p.shadow_vector = p.contribution = vec3(0.0);
    return p;
}
