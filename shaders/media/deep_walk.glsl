// Paths deep in a dense medium, where they would collide hundreds of times: from sphere to sphere, as long as these
// stay away from surfaces and lamps (viewer/trace/scene/deep_media.py; Muller 1956, "Some Continuous Monte Carlo
// Methods for the Dirichlet Problem"). A path is scattered evenly at a point of the sphere that is chosen evenly, and
// weighs
//   kappa R / sinh(kappa R),    in a white medium 1.
#include "bsdf/constants.glsl"
#include "media/clearance.glsl"

uniform int u_deep_media; // section of the scene buffer

const int MOST_SPHERES = 64; // at once

// x / sinh(x), for small x by its series, where the difference of exponentials would lose digits
vec3 over_sinh(vec3 x) {
    x = min(x, 80.0);
    vec3 large = 2.0 * x * exp(-x) / max(1.0 - exp(-2.0 * x), 1e-3);
    return mix(1.0 / (1.0 + x * x * (1.0 / 6.0 + x * x / 120.0)), large, greaterThan(x, vec3(0.3)));
}

vec3 on_sphere(vec2 u) {
    float z = 1.0 - 2.0 * u.x, phi = 2.0 * PI * u.y;
    return vec3(sqrt(max(1.0 - z * z, 0.0)) * vec2(cos(phi), sin(phi)), z);
}

// How far the medium, its surfaces and the lamps in it leave room about a point, at least
float room_about(vec3 p, int medium) {
    float room = clear_radius(p);
#if HAS_FOG
    if (medium == 0) {
        float beside = beside_clearance(p); // all that is in the fog lies in the grid
        room = min(beside > 0.0 ? beside : room, MEDIA_REACH - length(p));
#if HAS_FOG == 2
        room = min(room, scene_float4(u_fog).x - p.y); // below the base the fog is homogeneous
#endif
    }
#endif
#if HAS_PUNCTUAL
    for (int k = 0; k < u_punctual_count; ++k) {
        vec4 light = scene_float4(u_punctual + 3 * k);
        if (light.w >= 0.0) room = min(room, distance(p, light.xyz));
    }
#endif
    return room;
}

// Takes a path on that was scattered in a medium. Each step counts as a collision, whose random numbers it takes.
void walk_deep(inout Path p, Sample s) {
    int medium = innermost(p.medium);
    vec4 record = scene_float4(u_deep_media + 2 * medium);
    vec2 first = scene_float4(u_deep_media + 2 * medium + 1).xy;
    float least = record.w / 3.0, room = 0.0;
    if (record.w > 0.0) room = room_about(p.origin, medium) - record.w - first.x - first.y;
    if (room <= least) return;
    vec4 u = vertex_numbers(s, p, FLIGHT_GROUP);
    float way = first.x + first.y * (2.0 * u.z - 1.0);
    p.origin += way * p.direction;
    p.throughput *= over_sinh(abs(way) * record.rgb);
    for (int k = 0; k < MOST_SPHERES; ++k) {
        room = room_about(p.origin, medium) - record.w;
        if (room <= least) break;
        p.origin += room * on_sphere(u.xy);
        p.throughput *= over_sinh(room * record.rgb);
        ++p.steps;
        u = vertex_numbers(s, p, FLIGHT_GROUP);
    }
    p.direction = on_sphere(u.xy);
    p.pdf = 0.0; // no light was asked at this point
    ++p.steps;
}
