// Writes the class of each path as a depth value. The later passes then shade only the paths of their class, by a depth
// test for equality. `discard` would give the same pictures, but software OpenGL runs a discarded fragment to its end.
// FIRST_HITS: write, in the home of each path, only the class of paths whose camera ray hit a surface or a curve, or
// met neither and collides in a medium; all others count as idle.
#include "trace/path_class.glsl"
#include "trace/state.glsl"
#if HAS_SCATTERING
#include "trace/flight.glsl"
#include "trace/volume_flight.glsl"
#endif

#if HAS_SCATTERING
// The class of a path in flight, whose ray hit a surface of this kind
int class_in_medium(ivec2 texel, int path_class) {
    Path p = read_path(texel, uvec4(0u));
    Medium m = medium_around(p);
    bool is_in_medium = false;
    if (scatters(m)) {
#if HAS_AIRLIGHT
        if (!p.is_lit && asks_lights(m)) return CLASS_AIRLIGHT;
#endif
        is_in_medium = flight_of(p, m, vertex_numbers(path_sample(texel, p.left), p, FLIGHT_GROUP).x) < way_of(p);
    }
#if HAS_GRIDS
    is_in_medium = is_in_medium || texelFetch(u_flight, texel, 0).x < NO_COLLISION;
#endif
    return is_in_medium ? CLASS_MEDIUM : path_class;
}
#endif

void main() {
#if FIRST_HITS
    ivec2 texel = place_of(ivec2(gl_FragCoord.xy));
#else
    ivec2 texel = source_of(ivec2(gl_FragCoord.xy));
#endif
    float status = texel.y < 0 ? float(IDLE) : sign(texelFetch(u_origin, texel, 0).w);
    int kind = hit_kind(texelFetch(u_hit, texel, 0));
    int path_class = CLASS_SHADE + kind;
    if (status == IDLE) path_class = CLASS_IDLE;
    else if (status == ENDED || kind == NO_KIND) path_class = CLASS_ENDED;
#if HAS_SCATTERING && !FIRST_HITS
    if (status == IN_FLIGHT) path_class = class_in_medium(texel, path_class);
#endif
#if FIRST_HITS
    bool is_first = path_class >= CLASS_SHADE && unpack_depth(texelFetch(u_radiance, texel, 0).w) == 0;
#if HAS_SCATTERING
    is_first = is_first && kind != KIND_BOUNDARY && texelFetch(u_medium, texel, 0).w > 0.0; // once for each ray
    bool meets_surface = kind != NO_KIND && kind != KIND_BOUNDARY;
    if (status == IN_FLIGHT && !meets_surface && unpack_depth(texelFetch(u_radiance, texel, 0).w) == 0
        && class_in_medium(texel, CLASS_IDLE) == CLASS_MEDIUM) {
        gl_FragDepth = class_depth(CLASS_FIRST_COLLISION);
        return;
    }
#endif
    path_class = is_first ? CLASS_FIRST_HIT : CLASS_IDLE;
#if HAS_CURVES
    if (is_first && kind == KIND_FIBRE) path_class = CLASS_SHADE + KIND_FIBRE;
#endif
#endif
    gl_FragDepth = class_depth(path_class);
}
