// A boundary between media of one index, at which nothing is reflected or bent: the path goes straight on in the other
// medium. Shadow rays pass it, too (viewer/trace/rays/shadow_media.py and trace/shadow_transmittance.glsl).
#include "trace/bounce.glsl"
#include "trace/write_state.glsl"

void main() {
    ivec2 texel = source_of(ivec2(gl_FragCoord.xy));
    uvec4 hit = texelFetch(u_hit, texel, 0);
    Path p = read_path(texel, hit);
    Interaction i = interact(unpack_hit(hit), -p.direction);
    continue_straight(p, i);
    p.medium = p.shadow_medium = cross_boundary(p.medium, i.medium, i.is_front);
    write_path(p, IN_FLIGHT);
}
