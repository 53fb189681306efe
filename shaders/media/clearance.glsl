// Where there is no surface, inside of solids that scatter light behind a boundary which refracts. A grid of cubes
// tells how far the nearest surface is, at least, from anywhere in a cube (viewer/trace/scene/clearance.py): from ball
// to ball a ray gets on without being traced (Hart 1996, "Sphere Tracing").
#include "trace/scene_buffer.glsl"

uniform int u_clearance; // section of the scene buffer

const int MOST_BALLS = 16;

// Whether the ray meets no surface before the distance `way`, as far as the grid knows; d: unit length
bool is_clear(vec3 o, vec3 d, float way) {
    vec4 place = scene_float4(u_clearance);
    ivec3 cells = ivec3(scene_uint4(u_clearance + 1).xyz);
    vec3 start = (o - place.xyz) * place.w;
    float end = way * place.w, t = 0.0;
    for (int k = 0; k < MOST_BALLS; ++k) {
        ivec3 cell = ivec3(floor(start + t * d));
        if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, cells))) return false;
        int i = cell.x + cells.x * (cell.y + cells.y * cell.z);
        uint bytes = scene_uint4(u_clearance + 2 + (i >> 4))[i >> 2 & 3];
        float radius = float(bytes >> (8 * (i & 3)) & 255u) / CLEARANCE_STEPS;
        if (radius == 0.0) return false;
        t += radius;
        if (t > end) return true;
    }
    return false;
}
