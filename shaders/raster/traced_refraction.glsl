// Radiance that two paths from each shaded point have found: `u_refracted` inside solid glass, `u_mirrored` reflected
// off its front (raster/refraction_step.frag). Where the nearest path began on another surface, we use its neighbours.
#include "raster/material.glsl"
#include "raster/joint_bilateral.glsl"

uniform sampler2D u_refracted, u_mirrored;
uniform sampler2D u_path_positions;

// a < 0 where no path began nearby
vec4 traced_light(sampler2D radiance, vec3 n) {
    return joint_bilateral_fetch(radiance, u_path_positions, v_position, n, vec3(0.0), vec4(-1.0));
}
