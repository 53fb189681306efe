// Traces the rays of a wavefront through our own BVH and writes the hit texture (viewer/trace/rays/intersect.py).
#include "trace/bvh.glsl"

uniform sampler2D u_origin, u_direction, u_shadow_origin, u_shadow_vector;

layout(location = 0) out uvec4 hit;
#if HAS_SCATTERING || HAS_PANES
uniform sampler2D u_medium;

layout(location = 1) out vec4 along;

vec3 shadow_transmittance(vec3 o, vec3 vector, int nesting); // trace/shadow_transmittance.glsl
#endif

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec4 origin = texelFetch(u_origin, texel, 0);
    if (origin.w == IDLE) discard;
    Found found = Found(0.0, MISS, 0u, vec2(0.0), 0u, true);
    if (sign(origin.w) == IN_FLIGHT)
        traverse(origin.xyz, texelFetch(u_direction, texel, 0).xyz, FARTHEST, false, found);
    hit = uvec4(found.code, found.triangle, floatBitsToUint(found.barycentric));
    vec3 vector = texelFetch(u_shadow_vector, texel, 0).xyz;
#if HAS_SCATTERING || HAS_PANES
    along = vec4(vec3(0.0), found.code == MISS ? -1.0 : found.t);
    int nesting = 0;
#if HAS_SCATTERING
    vec4 medium = texelFetch(u_medium, texel, 0);
    nesting = int(medium.w < 0.0 || medium.y < 0.0 ? medium.x : medium.y);
#endif
    if (vector != vec3(0.0))
        along.rgb = shadow_transmittance(texelFetch(u_shadow_origin, texel, 0).xyz, vector, nesting);
#else
    if (vector != vec3(0.0) && !traverse(texelFetch(u_shadow_origin, texel, 0).xyz, vector, SHADOW_REACH, true, found))
        hit.x |= FREE;
#endif
}
