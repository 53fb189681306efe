// Where a pixel shows a second surface, or the first covers some samples alone, their mean: what is blended with the
// first surface, and the part that this has.
uniform usampler2D u_chosen; // raster/choose.frag
uniform sampler2D u_second;  // radiance of the second surface

layout(location = 0, index = 0) out vec4 o_color;
layout(location = 0, index = 1) out vec4 o_first;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uvec2 bits = texelFetch(u_chosen, pixel, 0).xy >> 24;
    vec4 second = texelFetch(u_second, pixel, 0);
    vec2 count = vec2(0.0);
    for (int k = 0; k < SAMPLES; ++k) count += vec2(bits >> k & 1u);
    o_color = count.y > 0.0 ? second * (count.y / float(SAMPLES)) : vec4(0.0); // nothing was stored there
    o_first = vec4(count.x / float(SAMPLES));
}
