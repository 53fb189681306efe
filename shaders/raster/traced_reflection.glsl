// What of the model itself a smooth surface mirrors, found beforehand by one ray a pixel. Where that began on another
// surface, the mean of those about it that began on this one.
#include "raster/mirror.glsl"
#include "raster/likeness.glsl"

uniform sampler2D u_reflected;     // radiance, and 1 where the ray met anything
uniform sampler2D u_ray_positions;

vec4 traced_reflection(vec3 position, vec3 n) {
    return look_up(u_reflected, u_ray_positions, position, n, vec4(0.0));
}
