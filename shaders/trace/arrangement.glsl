// Where the paths of a wavefront lie: viewer/trace/paths/arrangement.py. Without SORTED each path lies in its home, the
// texel of its block and pixel.
#if SORTED
uniform isampler2D u_source, u_home, u_place;

// Both coordinates are in one number.
ivec2 texel_of(int number) {
    return ivec2(number & 0xffff, number >> 16);
}
#endif

// The texel of the present state that has the path which goes to a texel of the next one
ivec2 source_of(ivec2 next) {
#if SORTED
    return texel_of(texelFetch(u_source, next, 0).x);
#else
    return next;
#endif
}

// The home of the path in a texel of the present state
ivec2 home_of(ivec2 texel) {
#if SORTED
    return texel_of(texelFetch(u_home, texel, 0).x);
#else
    return texel;
#endif
}

// The texel of the present state that has the path with this home; y is -1 if that is idle and has none
ivec2 place_of(ivec2 home) {
#if SORTED
    return texel_of(texelFetch(u_place, home, 0).x);
#else
    return home;
#endif
}
