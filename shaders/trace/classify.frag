// Writes the class of each path as a depth value. The later passes then shade only the paths of their class, by a depth
// test for equality. `discard` would give the same pictures, but software OpenGL runs a discarded fragment to its end.
// FIRST_HITS: write only the class of paths whose camera ray hit a surface; all others count as idle.
#include "trace/path_class.glsl"
#include "trace/state.glsl"

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float status = texelFetch(u_origin, texel, 0).w;
    int kind = hit_kind(texelFetch(u_hit, texel, 0));
    int path_class = CLASS_SHADE + kind;
    if (status == IDLE) path_class = CLASS_IDLE;
    else if (status == ENDED || kind == NO_KIND) path_class = CLASS_ENDED;
#if FIRST_HITS
    bool is_first = path_class >= CLASS_SHADE && unpack_depth(texelFetch(u_radiance, texel, 0).w) == 0;
    path_class = is_first ? CLASS_FIRST_HIT : CLASS_IDLE;
#endif
    gl_FragDepth = class_depth(path_class);
}
