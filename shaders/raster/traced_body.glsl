// What arrives at the front of a body of glass, inside of it and mirrored, found by two paths a point beforehand
// (raster/refraction_step.frag). Where they began on another surface, the mean of those about it that began here.
#include "raster/material.glsl"
#include "raster/likeness.glsl"

uniform sampler2D u_refracted, u_mirrored;
uniform sampler2D u_path_positions;

// a < 0 where none began
vec4 traced_body(sampler2D found, vec3 n) {
    return look_up(found, u_path_positions, v_position, n, vec4(-1.0));
}
