// The point of a surface that pbr.frag shades, and what light from behind meets on its way to it.
#include "raster/material.glsl"
#include "raster/normal.glsl"
#include "raster/sees_lamps_through.glsl"
#define SCATTERS_INSIDE (SUBSURFACE == 1 || SUBSURFACE == 2)
#if SUBSURFACE
// Thickness d, roundness: 0 a slab, 1 a ball; the way straight through the solid, and by how much of the tangential
// part of a direction the normal of the other side turns. Lengths are in eye-relative units.
in vec4 v_interior;
#endif
#if IS_ORTHOGRAPHIC
uniform vec3 u_view_direction; // towards the eye
#endif

// The normals of the surface, and the direction v to the eye
struct Point {
    vec3 n, n_geometric, v;
    float NoV;
#if DIFFUSE_TRANSMISSION || SEES_LAMPS_THROUGH
    float behind;  // distance to the other side, 0 if thin-walled
#endif
#if DIFFUSE_TRANSMISSION
    vec3 returned; // share of the light that the diffuse transmission brings from this side, 0 if thin-walled
#endif
#if SCATTERS_INSIDE
    vec3 everywhere; // share of the mean light on all sides of a solid that its medium brings to each
#endif
#if SEES_LAMPS_THROUGH
    vec3 clear;        // share of the light from behind that passes without being scattered inside
    float clear_alpha; // roughness of both boundaries together, as that of a reflected lobe
    vec3 bent;         // what lies straight behind, less what is seen there
#endif
#if ANISOTROPIC
    mat3 frame; // tangent, bitangent, n
#endif
#if GROOVED
    float unhidden; // what the lobe would reflect without masking, as a multiple of what it does
#endif
#if LIGHT_COUNT > 0
    vec2 alphas; // of the lobes of lights, which are widened over the pixel by themselves
    float coat_alpha;
    float facet_alpha, coat_facet_alpha; // the same without what a normal map's mip level adds: of each of its texels
#endif
};

// The point with its normals, the direction to the eye and the frame; the callers fill in the rest.
Point shaded_point(MaterialInputs m) {
    Point p;
    p.n_geometric = geometric_normal();
    p.n = shading_normal(p.n_geometric);
    p.v = -normalize(v_position);
#if IS_ORTHOGRAPHIC
    p.v = u_view_direction;
#endif
#if SUBSURFACE == 2
    p.v = p.n;
#endif
#if NORMAL_MAP && HAS_TANGENT && SUBSURFACE != 2
    p.n = bent_over_triangle(p.n, p.n_geometric, p.v);
#endif
    p.NoV = clamp(dot(p.n, p.v), 1e-4, 1.0);
#if ANISOTROPIC
    p.frame = anisotropy_frame(m, p.n);
#endif
    return p;
}
