// What a surface's lobe meets of the model, found beforehand by a ray a pixel: the light that comes from there, and the
// part of the lobe that it fills.
#include "raster/likeness.glsl"
#include "raster/lobe_shares.glsl"

uniform sampler2D u_reflected;
uniform sampler2D u_ray_positions;

vec4 traced_reflection(vec3 position, vec3 n) {
    return look_up(u_reflected, u_ray_positions, position, n, vec4(0.0));
}
