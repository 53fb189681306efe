// The point of a triangle that a pixel of the screen shows, and what is interpolated there (Burns and Hunt 2013, "The
// Visibility Buffer"). The triangle's number comes from raster/choose.frag.
#include "raster/material.glsl"
#include "raster/chosen.glsl"

uniform usampler2D u_chosen;
uniform int u_layer;           // 0: shade the first, 1: the second
uniform uint u_first_triangle; // the number of the mesh's first triangle, with its object's
uniform uint u_triangles;      // how many it has
uniform samplerBuffer u_geometry; // a texel for each triangle, its vertices; then four for each vertex
uniform mat4 u_model;
#if HAS_NORMAL
uniform mat3 u_normal_matrix;
#endif
uniform float u_handedness;
uniform mat3 u_pixel_ray;    // (x, y, 1), in pixels, to a ray's direction
#if IS_ORTHOGRAPHIC
uniform mat3 u_pixel_origin; // and to its start, which is the eye elsewhere
#endif

vec4 geometry(int texel) {
    return texelFetch(u_geometry, texel);
}

void find_surface() {
    uvec2 numbers = chosen_numbers(texelFetch(u_chosen, ivec2(gl_FragCoord.xy), 0).xy);
    uint triangle = (u_layer == 0 ? numbers.x : numbers.y) - u_first_triangle;
    bool is_mine = triangle < u_triangles; // not in pixels that only help with derivatives
    vec3 corners = geometry(is_mine ? int(triangle) : 0).xyz;
    ivec3 at = int(u_triangles) + 4 * ivec3(corners);
    vec4 a0 = geometry(at.x), a1 = geometry(at.y), a2 = geometry(at.z);
    vec3 p0 = (u_model * vec4(a0.xyz, 1.0)).xyz;
    mat2x3 edge = mat2x3(mat3(u_model) * (a1.xyz - a0.xyz), mat3(u_model) * (a2.xyz - a0.xyz));

    // Where the ray o + t d meets the triangle (Moeller and Trumbore 1997), and the derivatives by the pixel's x and y
    vec3 pixel = vec3(gl_FragCoord.xy, 1.0), d = u_pixel_ray * pixel;
#if IS_ORTHOGRAPHIC
    vec3 s = u_pixel_origin * pixel - p0;
#else
    vec3 s = -p0;
#endif
    vec3 dxe = cross(d, edge[1]), sxe = cross(s, edge[0]);
    float determinant = dot(edge[0], dxe), inverse = determinant != 0.0 ? 1.0 / determinant : 0.0;
    deferred_front = determinant * u_handedness > 0.0;
    vec2 b = vec2(dot(s, dxe), dot(d, sxe)) * inverse;
    mat2 slope;
    for (int k = 0; k < 2; ++k) {
        vec3 turned = cross(u_pixel_ray[k], edge[1]);
        slope[k] = vec2(dot(s, turned), dot(u_pixel_ray[k], sxe)) - b * dot(edge[0], turned);
#if IS_ORTHOGRAPHIC
        vec3 moved = u_pixel_origin[k];
        slope[k] += vec2(dot(moved, dxe), dot(d, cross(moved, edge[0])));
#endif
        slope[k] *= inverse;
    }
    // As in OpenGL's multisampling, a triangle that covers samples but not the centre is continued to there, but not
    // far: it may be seen edge-on.
    b = clamp(b, -1e6, 1e6);
    vec3 inside = max(vec3(1.0 - b.x - b.y, b), -1.0);
    b = inside.yz / (inside.x + inside.y + inside.z);

    deferred_face = u_handedness * cross(edge[0], edge[1]);
    mat2x3 position_slope = edge * slope;
    deferred_footprint = length(position_slope[0]) + length(position_slope[1]);
    v_position = is_mine ? p0 + edge * b : vec3(0.0);
    vec3 apart_x = dFdx(v_position) - position_slope[0], apart_y = dFdy(v_position) - position_slope[1];
    deferred_alike = lessThan(vec2(dot(apart_x, apart_x), dot(apart_y, apart_y)),
        0.25 * vec2(dot(position_slope[0], position_slope[0]), dot(position_slope[1], position_slope[1])));
#if HAS_NORMAL
    vec4 n0 = geometry(at.x + 1), n1 = geometry(at.y + 1), n2 = geometry(at.z + 1);
    v_normal = u_normal_matrix * (n0.xyz + mat2x3(n1.xyz - n0.xyz, n2.xyz - n0.xyz) * b);
#elif UV_SETS & 1
    vec4 n0 = geometry(at.x + 1), n1 = geometry(at.y + 1), n2 = geometry(at.z + 1);
#endif
#if UV_SETS & 1
    mat2 uv0_edge = mat2(a1.w - a0.w, n1.w - n0.w, a2.w - a0.w, n2.w - n0.w);
    v_uv0 = vec2(a0.w, n0.w) + uv0_edge * b;
    deferred_uv0_slope = uv0_edge * slope;
#endif
#if HAS_TANGENT
    vec4 t0 = geometry(at.x + 2), t1 = geometry(at.y + 2), t2 = geometry(at.z + 2);
    vec4 tangent = t0 + mat2x4(t1 - t0, t2 - t0) * b;
    v_tangent = vec4(mat3(u_model) * tangent.xyz, tangent.w * u_handedness);
#endif
#if UV_SETS & 2
    vec2 uv1 = geometry(at.x + 3).xy;
    mat2 uv1_edge = mat2(geometry(at.y + 3).xy - uv1, geometry(at.z + 3).xy - uv1);
    v_uv1 = uv1 + uv1_edge * b;
    deferred_uv1_slope = uv1_edge * slope;
#endif
}
