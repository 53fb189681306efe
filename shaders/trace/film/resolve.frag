// A wave's sums, added to the film's: a tile may be in several blocks, which come one after the other.
uniform sampler2D u_first, u_second;

flat in ivec2 v_to_slot;

layout(location = 0) out vec4 o_first;
layout(location = 1) out vec4 o_second;

void main() {
    ivec2 slot = ivec2(gl_FragCoord.xy) + v_to_slot;
    o_first = texelFetch(u_first, slot, 0);
    o_second = texelFetch(u_second, slot, 0);
}
