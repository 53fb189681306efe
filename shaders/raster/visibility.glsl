// Visibility of the environment, found beforehand for one sample a pixel or less.
#include "raster/joint_bilateral.glsl"

uniform sampler2D u_visibility; // rgb: of the irradiance, a: of the specular lobe
uniform sampler2D u_positions;  // w: 0 where it is empty, else its shading normal, packed, if it has one

// `n_geometric` and `n`: of the triangle and of the shaded surface, by which the light is weighted.
vec4 visibility(vec3 position, vec3 n_geometric, vec3 n) {
    return joint_bilateral_fetch(u_visibility, u_positions, position, n_geometric, n, vec4(1.0));
}
