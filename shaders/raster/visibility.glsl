// How much of the environment's light a surface sees, found beforehand for one sample a pixel.
#include "raster/likeness.glsl"

uniform sampler2D u_visibility; // rgb: of what the hemisphere sends, a: of what it reflects
uniform sampler2D u_positions;

vec4 visibility(vec3 position, vec3 n) {
    return look_up(u_visibility, u_positions, position, n, vec4(1.0));
}
