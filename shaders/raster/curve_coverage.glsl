// Which fragments of a strip its curve covers: the round ends of strands, and the share of a strip that was widened.
in float v_across;
in vec2 v_beyond;
in float v_share;
flat in uint v_number;
#if YARN
#include "raster/yarn_medium.glsl"
#endif

// A threshold in (0, 1) for each pixel and segment, so that what several thin curves leave free is about the product of
// their shares. The hash is PCG3D (Jarzynski and Olano 2020).
float threshold() {
    uvec3 v = uvec3(gl_FragCoord.xy, v_number) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    return (float(v.x >> 8) + 0.5) / 16777216.0;
}

bool is_covered() {
    float beyond = max(v_beyond.x, v_beyond.y);
    if (beyond > 0.0 && beyond * beyond + v_across * v_across > 1.0) return false;
    float share = v_share;
#if YARN
    if (u_tube > 0.0) share *= tube_opacity(v_across);
#endif
    return share >= 1.0 || threshold() < share;
}
