// Where there is no surface, inside of solids that scatter light behind a boundary which refracts, and in media in
// which paths take long steps (media/deep_walk.glsl). A grid of cubes tells how far the nearest surface is, at least,
// from anywhere in a cube (viewer/trace/scene/clearance.py): from ball to ball a ray gets on without being traced (Hart
// 1996, "Sphere Tracing").
#include "trace/scene_buffer.glsl"

uniform int u_clearance; // section of the scene buffer

const int MOST_BALLS = 16;

// How far the nearest surface is from anywhere in a cell of the grid, at least, in cells; 0 outside of the grid
float cell_radius(ivec3 cell, ivec3 cells) {
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, cells))) return 0.0;
    int i = cell.x + cells.x * (cell.y + cells.y * cell.z);
    uint bytes = scene_uint4(u_clearance + 2 + (i >> 4))[i >> 2 & 3];
    return float(bytes >> (8 * (i & 3)) & 255u) / CLEARANCE_STEPS;
}

// The same of a point, in tracer units
float clear_radius(vec3 p) {
    vec4 place = scene_float4(u_clearance);
    ivec3 cell = ivec3(floor((p - place.xyz) * place.w));
    return cell_radius(cell, ivec3(scene_uint4(u_clearance + 1).xyz)) / place.w;
}

// How far a point is from the grid, 0 inside
float beside_clearance(vec3 p) {
    vec4 place = scene_float4(u_clearance);
    vec3 high = place.xyz + vec3(scene_uint4(u_clearance + 1).xyz) / place.w;
    return length(max(max(place.xyz - p, p - high), 0.0));
}

// Whether the ray meets no surface before the distance `way`, as far as the grid knows; d: unit length
bool is_clear(vec3 o, vec3 d, float way) {
    vec4 place = scene_float4(u_clearance);
    ivec3 cells = ivec3(scene_uint4(u_clearance + 1).xyz);
    vec3 start = (o - place.xyz) * place.w;
    float end = way * place.w, t = 0.0;
    for (int k = 0; k < MOST_BALLS; ++k) {
        float radius = cell_radius(ivec3(floor(start + t * d)), cells);
        if (radius == 0.0) return false;
        t += radius;
        if (t > end) return true;
    }
    return false;
}
