// Reflections of the model, traced beforehand with rays from each shaded point and filtered
// (raster/reflected_mean.frag).
#include "raster/joint_bilateral.glsl"

uniform sampler2D u_reflected; // rgb: radiance from the model, a: part of the environment's light that it occludes
uniform sampler2D u_ray_positions; // w: 0 where it is empty, else the shading normal, packed

// Weight of the traced reflection against the untraced one. A few pixels' rays cannot represent a very wide lobe, so
// the traced reflection fades out there.
float traced_share(float perceptual_roughness) {
    return 1.0 - smoothstep(0.8, 1.0, perceptual_roughness);
}

// `n_geometric` and `n`: of the triangle and of the shaded surface
vec4 traced_reflection(vec3 position, vec3 n_geometric, vec3 n) {
    return joint_bilateral_fetch(u_reflected, u_ray_positions, position, n_geometric, n, vec4(0.0));
}
