// Visibility of the environment, found beforehand for one sample a pixel.
#include "raster/joint_bilateral.glsl"

uniform sampler2D u_visibility; // rgb: of the irradiance, a: of the specular lobe
uniform sampler2D u_positions;

vec4 visibility(vec3 position, vec3 n) {
    return joint_bilateral_fetch(u_visibility, u_positions, position, n, vec4(1.0));
}
