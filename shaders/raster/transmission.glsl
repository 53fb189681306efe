// Light that comes through a surface from behind, by what the screen shows there: the picture of all that is opaque, in
// levels ever more blurred (viewer/raster/transmission.py). KHR_materials_transmission, KHR_materials_volume.
// Behind a thin wall light goes on as before; IS_SOLID: it is refracted at the front of a volume.
#include "raster/material.glsl"
#include "raster/backdrop.glsl"
#if TRACED_BODIES
#include "raster/traced_body.glsl"
#endif
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif

#if IS_SOLID
uniform vec3 u_absorption; // Beer's sigma
#endif

// Both faces of a wall, R' = 2 R / (1 + R)
vec3 wall_f0(vec3 f0) {
    return 2.0 * f0 / (1.0 + f0);
}

// Of the lobe that goes through: as the difference of the indices, and at 1.5 like the reflected one
float transmitted_roughness(float perceptual_roughness, float ior) {
    return perceptual_roughness * clamp(2.0 * ior - 2.0, 0.0, 1.0);
}

#if IS_SOLID
// Mean curvature of the surface, by the differences of normals n and places p of neighbouring pixels: 1 / r on a ball
float curvature(vec3 n, vec3 p) {
    vec3 nx = dFdx(n), ny = dFdy(n), px = dFdx(p), py = dFdy(p);
    return (dot(nx, px) + dot(ny, py)) / max(dot(px, px) + dot(py, py), 1e-18);
}

// Where light that goes along d inside comes out after `way`. The far side is taken to be concentric with the front:
// the other half of a ball, the inner face of a vase, or, where the front is flat, a plane parallel to it.
vec3 leaving_direction(vec3 n, vec3 d, float way, float ior) {
    vec3 out_n = normalize(n + curvature(n, v_position) * way * d);
    out_n *= dot(out_n, d) > 0.0 ? -1.0 : 1.0;
    vec3 beyond = refract(d, out_n, ior);
    return beyond == vec3(0.0) ? reflect(d, out_n) : beyond;
}
#endif

// The base colour tints what passes once: traced paths have half of it where they come out.
vec3 entering_tint(vec3 base_color) {
#if TRACED_BODIES
    return sqrt(max(base_color, vec3(0.0)));
#else
    return base_color;
#endif
}

// Where nothing was drawn, and beyond the picture, stands the environment.
vec3 light_from_behind(MaterialInputs m, vec3 n, vec3 n_geometric, vec3 v, float blur) {
#if TRACED_BODIES
    vec4 found = traced_body(u_refracted, n_geometric);
    if (found.a >= 0.0) return found.rgb;
#endif
    vec3 exit = v_position, d = -v;
    vec3 kept = vec3(1.0);
#if IS_SOLID
    d = refract(-v, n, 1.0 / m.ior);
    exit += m.thickness * d; // eye-relative units
    kept = exp(-u_absorption * m.thickness);
    d = leaving_direction(n_geometric, d, m.thickness, m.ior);
#endif
    vec4 behind = backdrop_at(exit, blur);
#if HAS_ENVIRONMENT
    behind.rgb += (1.0 - behind.a) * environment_specular(d, blur);
#endif
    return kept * behind.rgb;
}
