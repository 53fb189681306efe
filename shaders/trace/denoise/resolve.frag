// Multiplies the filtered light by the albedo of the first hit and adds its emission again. Alpha stays as it was.
#include "trace/denoise/color.glsl"

uniform sampler2D u_light;
uniform sampler2D u_albedo;
uniform sampler2D u_emission;
uniform sampler2D u_sum;
uniform sampler2D u_radiance;
out vec4 o_radiance;

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    vec3 light = texelFetch(u_light, p, 0).rgb;
    vec4 albedo = texelFetch(u_albedo, p, 0);
    vec3 seen = albedo.w > 0.0 ? texelFetch(u_emission, p, 0).rgb / texelFetch(u_sum, p, 0).w : vec3(0.0);
    o_radiance = vec4(light * demodulation(albedo) + seen, texelFetch(u_radiance, p, 0).a);
}
