// What a surface's lobe meets of the model, found beforehand by a ray a point: the light that comes from there, and which
// part of the environment's it hides.
#include "raster/likeness.glsl"

uniform sampler2D u_reflected;
uniform sampler2D u_ray_positions;

// How far the rays of a few pixels speak for all that a rough surface reflects.
float traced_share(float perceptual_roughness) {
    return 1.0 - smoothstep(0.8, 1.0, perceptual_roughness);
}

vec4 traced_reflection(vec3 position, vec3 n) {
    return look_up(u_reflected, u_ray_positions, position, n, vec4(0.0));
}
