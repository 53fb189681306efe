// Which of a list of hits a shadow ray goes through: 1, or else 0. A hit has two texels: its words, and the ray's vector.
#include "trace/see_through.glsl"

uniform usampler2D u_hits;

layout(location = 0) out float passes;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy) * ivec2(2, 1);
    uvec4 word = texelFetch(u_hits, texel, 0);
    vec3 vector = uintBitsToFloat(texelFetch(u_hits, texel + ivec2(1, 0), 0).xyz);
    passes = goes_through(unpack_hit(word), vector) ? 1.0 : 0.0;
}
