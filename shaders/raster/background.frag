// The environment behind everything, unfiltered.
#include "light/equirect.glsl"

uniform sampler2D u_background;
uniform mat3 u_ray;          // (x, y, 1) in normalised device coordinates to a direction in the environment
uniform float u_lod;         // of the map that matches a pixel
uniform float u_environment_intensity;

in vec2 v_ndc;
out vec4 o_color;

void main() {
    vec3 d = normalize(u_ray * vec3(v_ndc, 1.0));
    vec3 radiance = textureLod(u_background, equirect_uv(d), u_lod).rgb * u_environment_intensity;
#if HALF_TARGET
    radiance = min(radiance, vec3(65504.0));
#endif
    o_color = vec4(radiance, 1.0);
}
