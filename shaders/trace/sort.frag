// What is to be done in each slot, as a depth, by which a pass leaves out all slots but its own: software OpenGL runs a
// shader to its end for what it discards, but not for what fails a depth test.
#include "trace/duty.glsl"
#include "trace/state.glsl"

void main() {
    ivec2 slot = ivec2(gl_FragCoord.xy);
    float status = texelFetch(u_origin, slot, 0).w;
    int kind = hit_kind(texelFetch(u_hit, slot, 0));
    int duty = status == IDLE ? CLASS_REST : status == ENDED || kind == NO_KIND ? CLASS_FINISH : CLASS_SHADE + kind;
#if FIRST_HITS
    bool is_first = duty >= CLASS_SHADE && unpack_depth(texelFetch(u_radiance, slot, 0).w) == 0;
    duty = is_first ? CLASS_FIRST_HIT : CLASS_REST;
#endif
    gl_FragDepth = duty_depth(duty);
}
