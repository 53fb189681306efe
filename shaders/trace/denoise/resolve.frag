// The filtered light with the first hit's colour put back; alpha is what it was.
#include "trace/denoise/color.glsl"

uniform sampler2D u_light;
uniform sampler2D u_albedo;
uniform sampler2D u_radiance;
out vec4 o_radiance;

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    vec3 light = texelFetch(u_light, p, 0).rgb;
    o_radiance = vec4(light * demodulation(texelFetch(u_albedo, p, 0)), texelFetch(u_radiance, p, 0).a);
}
