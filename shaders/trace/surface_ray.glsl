// First rays from a list of surface points instead of a camera, one texel each (viewer/trace/paths/surface_rays.py).
// RAYS: 1 for rays from the surface into the hemisphere, with a density in proportion to the cosine; 2 for rays to the
// surface, from just above it against its normal
#include "sample/hemisphere.glsl"
#include "sample/orthonormal_basis.glsl"
#include "trace/offset_origin.glsl"

uniform sampler2D u_ray_point;            // on the surface; w: 1, or 0 beyond the end of the list
uniform sampler2D u_ray_normal;           // shading normal
uniform sampler2D u_ray_normal_geometric; // geometric normal, on the side of the shading normal

// Returns false beyond the end of the list.
bool surface_ray(ivec2 pixel, vec2 u, out vec3 o, out vec3 d) {
    vec4 point = texelFetch(u_ray_point, pixel, 0);
    vec3 n = texelFetch(u_ray_normal, pixel, 0).xyz, n_geometric = texelFetch(u_ray_normal_geometric, pixel, 0).xyz;
    o = offset_origin(point.xyz, n_geometric);
#if RAYS == 1
    d = orthonormal_basis(n) * sample_cosine_hemisphere(u);
    d = normalize(d - 2.0 * min(dot(d, n_geometric), 0.0) * n_geometric); // mirrored if it would enter the surface
#else
    d = -n;
#endif
    return point.w != 0.0;
}
