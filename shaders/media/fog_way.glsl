// The fog of the path tracer: medium 0, in the ball about the scene where media are, but not in the boxes of volumes,
// which displace it. Its density is 1 or, with HAS_FOG 2, thins out with height. The way of a ray in it is counted as
// the length, at the density 1, of the same optical depth: then all that holds of a homogeneous medium holds of the
// fog. viewer/trace/scene/fog.py writes its section of the scene buffer, and does the same for Embree.
#include "media/height_fog.glsl"

uniform int u_fog; // height of the base, 1 / scale height, number of boxes; then three rows of each box

vec2 media_span(vec3 o, vec3 d); // media/medium.glsl

#if HAS_GRIDS
// The part of a ray that lies in a box; of one that misses it the end is before the start.
vec2 box_span(int k, vec3 o, vec3 d) {
    vec2 span = vec2(-NO_COLLISION, NO_COLLISION);
    for (int axis = 0; axis < 3; ++axis) {
        vec4 row = scene_float4(u_fog + 1 + 3 * k + axis);
        float start = dot(row.xyz, o) + row.w, slope = dot(row.xyz, d);
        if (slope == 0.0) {
            if (start < 0.0 || start > 1.0) return vec2(NO_COLLISION, -NO_COLLISION);
            continue;
        }
        vec2 t = (vec2(0.0, 1.0) - start) / slope;
        span = vec2(max(span.x, min(t.x, t.y)), min(span.y, max(t.x, t.y)));
    }
    return span.x < span.y ? span : vec2(NO_COLLISION, -NO_COLLISION);
}

bool is_in_box(int k, vec3 p) {
    for (int axis = 0; axis < 3; ++axis) {
        vec4 row = scene_float4(u_fog + 1 + 3 * k + axis);
        float at = dot(row.xyz, p) + row.w;
        if (at < 0.0 || at > 1.0) return false;
    }
    return true;
}
#endif

// The next piece of a ray beside the volumes, from `from` on and at most to `end`; none if it begins at the end or
// later
vec2 fog_piece(vec3 o, vec3 d, float from, float end) {
    vec2 piece = vec2(from, end);
#if HAS_GRIDS
    int boxes = int(scene_float4(u_fog).z);
    bool is_covered = true;
    while (is_covered && piece.x < end) {
        is_covered = false;
        for (int k = 0; k < boxes; ++k) {
            vec2 box = box_span(k, o, d);
            if (box.x <= piece.x && piece.x < box.y) {
                piece.x = box.y;
                is_covered = true;
            }
        }
    }
    for (int k = 0; k < boxes; ++k) {
        float start = box_span(k, o, d).x;
        if (start > piece.x) piece.y = min(piece.y, start);
    }
#endif
    return piece;
}

#if HAS_FOG == 2
// The height of a point of a ray in scale heights above the base, and how much it rises a unit of length
vec2 fog_slope(vec3 o, vec3 d, float t) {
    vec4 fog = scene_float4(u_fog);
    return vec2(o.y + t * d.y - fog.x, d.y) * fog.y;
}
#endif

float piece_length(vec3 o, vec3 d, vec2 piece) {
#if HAS_FOG == 2
    return (piece.y - piece.x) * mean_density(fog_slope(o, d, piece.x).x, fog_slope(o, d, piece.y).x);
#else
    return piece.y - piece.x;
#endif
}

// Of a ray between two distances
float fog_length(vec3 o, vec3 d, float from, float to) {
    vec2 span = media_span(o, d);
    from = max(from, span.x);
    to = min(to, span.y);
    float sum = 0.0;
    while (from < to) {
        vec2 piece = fog_piece(o, d, from, to);
        if (piece.x >= to) break;
        sum += piece_length(o, d, piece);
        from = piece.y;
    }
    return sum;
}

// The distance at which a length lies behind, NO_COLLISION if the fog ends before
float fog_distance(vec3 o, vec3 d, float s) {
    vec2 span = media_span(o, d);
    float from = span.x;
    while (from < span.y) {
        vec2 piece = fog_piece(o, d, from, span.y);
        if (piece.x >= span.y) break;
        float all = piece_length(o, d, piece);
        if (s <= all) {
#if HAS_FOG == 2
            vec2 slope = fog_slope(o, d, piece.x);
            s = distance_to_dense(slope.x, slope.y, s);
#endif
            return min(piece.x + s, piece.y);
        }
        s -= all;
        from = piece.y;
    }
    return NO_COLLISION;
}

// At a point in the ball
float fog_density(vec3 p) {
#if HAS_GRIDS
    int boxes = int(scene_float4(u_fog).z);
    for (int k = 0; k < boxes; ++k)
        if (is_in_box(k, p)) return 0.0;
#endif
#if HAS_FOG == 2
    vec4 fog = scene_float4(u_fog);
    return exp(-max((p.y - fog.x) * fog.y, 0.0));
#else
    return 1.0;
#endif
}
