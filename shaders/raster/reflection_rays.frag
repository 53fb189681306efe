// A ray from each pixel's surface along its mirror direction, where that is smooth enough: in tracer space, the scene's
// centre at the origin and its radius the unit (viewer/trace/geometry.py).
#include "raster/octahedron.glsl"
#include "raster/mirror.glsl"

uniform sampler2D u_positions;
uniform sampler2D u_normals;
uniform vec3 u_eye;            // in tracer space
uniform vec3 u_view_direction; // towards the eye

layout(location = 0) out vec4 o_origin; // w: 1 where there is a ray
layout(location = 1) out vec4 o_direction;

// A position has the rounding of a float as far as the eye is away, and of the rasteriser's interpolation.
const float OFFSET = 2e-5;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(u_positions, pixel, 0);
    o_origin = o_direction = vec4(0.0);
    if (surface.w == 0.0 || mirror_share(surface.w) == 0.0) return;
    vec4 normals = texelFetch(u_normals, pixel, 0);
    vec3 n = from_octahedron(normals.xy), face = from_octahedron(normals.zw);
#if IS_ORTHOGRAPHIC
    vec3 v = u_view_direction;
#else
    vec3 v = -normalize(surface.xyz);
#endif
    vec3 d = reflect(-v, n);
    d -= 2.0 * min(dot(d, face), 0.0) * face; // a shading normal may send it under the triangle it starts from
    vec3 away = OFFSET * max(1.0, length(surface.xyz)) * face;
    o_origin = vec4(u_eye + surface.xyz + away, 1.0);
    o_direction = vec4(normalize(d), 1.0);
}
