// Rays of a list instead of a camera's, a texel each (viewer/trace/paths/surface_rays.py).
// RAYS: 1 from a surface into the hemisphere, in proportion to the cosine; 2 at it, from just off it along its normal
#include "sample/hemisphere.glsl"
#include "trace/offset_origin.glsl"

uniform sampler2D u_ray_point;   // on the surface, 1 where there is one
uniform sampler2D u_ray_normal;  // for shading
uniform sampler2D u_ray_outside; // geometric normal, on the side of the other

// False where the list has none.
bool surface_ray(ivec2 pixel, vec2 u, out vec3 o, out vec3 d) {
    vec4 point = texelFetch(u_ray_point, pixel, 0);
    vec3 n = texelFetch(u_ray_normal, pixel, 0).xyz, outside = texelFetch(u_ray_outside, pixel, 0).xyz;
    o = offset_origin(point.xyz, outside);
#if RAYS == 1
    vec3 local = sample_cosine_hemisphere(u);
    // Duff et al. 2017, "Building an Orthonormal Basis, Revisited"
    float s = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (s + n.z), b = n.x * n.y * a;
    d = local.x * vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x)
      + local.y * vec3(b, s + n.y * n.y * a, -n.y) + local.z * n;
    d = normalize(d - 2.0 * min(dot(d, outside), 0.0) * outside); // not into the surface itself
#else
    d = -n;
#endif
    return point.w != 0.0;
}
