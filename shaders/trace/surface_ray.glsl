// First rays from a list of surface points instead of a camera, three texels each (viewer/trace/paths/surface_rays.py).
// RAYS: 1 for rays from the surface into the hemisphere, with a density in proportion to the cosine; 2 for rays to the
// surface, from just above it against its normal
#include "sample/hemisphere.glsl"
#include "sample/orthonormal_basis.glsl"
#include "trace/offset_origin.glsl"

// The point on the surface with w 1, or 0 beyond the end of the list; shading normal; geometric normal on its side
uniform sampler2D u_surface_rays;

struct RayPoint {
    vec3 position;
    vec3 n, n_geometric;
};

// Returns false beyond the end of the list.
bool ray_point(ivec2 pixel, out RayPoint at) {
    ivec2 first = ivec2(3 * pixel.x, pixel.y);
    vec4 point = texelFetch(u_surface_rays, first, 0);
    at = RayPoint(point.xyz, texelFetch(u_surface_rays, first + ivec2(1, 0), 0).xyz,
                  texelFetch(u_surface_rays, first + ivec2(2, 0), 0).xyz);
    return point.w != 0.0;
}

#if RAYS == 1
// The density by solid angle of a direction from surface_ray, which leaves the surface
float surface_ray_pdf(RayPoint at, vec3 d) {
    vec3 mirrored = d - 2.0 * dot(d, at.n_geometric) * at.n_geometric;
    return (max(dot(at.n, d), 0.0) + max(dot(at.n, mirrored), 0.0)) * INV_PI;
}
#endif

void surface_ray(RayPoint at, vec2 u, out vec3 o, out vec3 d) {
    o = offset_origin(at.position, at.n_geometric);
#if RAYS == 1
    d = orthonormal_basis(at.n) * sample_cosine_hemisphere(u);
    d = normalize(d - 2.0 * min(dot(d, at.n_geometric), 0.0) * at.n_geometric); // mirrored if it would enter
#else
    d = -at.n;
#endif
}
