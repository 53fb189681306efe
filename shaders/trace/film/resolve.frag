// A wave's sums, added to the film's: a tile may be in several blocks, which come one after the other.
// COUNT: how many there are, 2 or 3
uniform sampler2D u_first, u_second;
#if COUNT == 3
uniform sampler2D u_third;
#endif

flat in ivec2 v_to_slot;

layout(location = 0) out vec4 o_first;
layout(location = 1) out vec4 o_second;
#if COUNT == 3
layout(location = 2) out vec4 o_third;
#endif

void main() {
    ivec2 slot = ivec2(gl_FragCoord.xy) + v_to_slot;
    o_first = texelFetch(u_first, slot, 0);
    o_second = texelFetch(u_second, slot, 0);
#if COUNT == 3
    o_third = texelFetch(u_third, slot, 0);
#endif
}
