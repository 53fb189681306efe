// Adds the splats of photons to those of earlier ones, by blending.
uniform sampler2D u_sum, u_squares;

layout(location = 0) out vec4 o_sum;
layout(location = 1) out vec4 o_squares;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    o_sum = texelFetch(u_sum, pixel, 0);
    o_squares = texelFetch(u_squares, pixel, 0);
}
