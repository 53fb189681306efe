// The point of a curve that a fragment shows. The fragments of blunt segments (curve_blunt.glsl) write their depth.
#include "raster/curve_coverage.glsl"
in vec3 v_position;
in vec3 v_along;
in float v_pixels;
in float v_radius;

struct CurvePoint {
    vec3 position; // eye-relative
    vec3 along;    // unit, root to tip
    float across;  // -1 to 1
    float pixels;  // width of the curve
    float radius;  // in eye-relative units
};

#if ROUND == 2
#include "raster/curve_sight.glsl"
#include "trace/curve.glsl"
uniform mat4 u_from_clip; // to the space of the points
uniform mat4 u_to_eye;    // from the space of the points
uniform float u_nudge;    // share by which depth comes nearer, so that what was drawn before does not hide itself
in vec2 v_screen;
flat in vec4 v_a, v_b;    // the ends of the segment and their radii
flat in vec3 v_along_a, v_along_b;

float nudged(float depth) {
    return u_nearer > 0.0 ? depth * (1.0 + u_nudge) : 1.0 - (1.0 - depth) * (1.0 + u_nudge) - 0.02 * u_nudge;
}

// Where the line of sight enters the segment. Nothing is left to discard after it returns true.
bool round_point(out CurvePoint at) {
    vec4 clip = u_to_clip * vec4(0.5 * (v_a.xyz + v_b.xyz), 1.0);
    float z = clip.w > 0.0 && abs(clip.z) <= clip.w ? clip.z / clip.w : 0.5;
    vec4 from = u_from_clip * vec4(v_screen, z, 1.0);
    vec3 x, y, o = from.xyz / from.w, front = sight(o, x, y);
    float share, t = segment_entry(o, -front, v_a, v_b, share);
    if (t >= 0.5 * NO_ENTRY) return false;
    vec3 p = o - t * front, center = mix(v_a.xyz, v_b.xyz, share);
    clip = u_to_clip * vec4(p, 1.0);
    float depth = clip.z / clip.w;
    if (u_nearer < 0.0) depth = 0.5 * depth + 0.5;
    if (clip.w <= 0.0 || depth < 0.0 || depth > 1.0) return false;
    gl_FragDepth = nudged(depth);
    float radius = mix(v_a.w, v_b.w, share);
    vec3 n = (p - center) / radius, tangent = mix(v_along_a, v_along_b, share);
    n = dot(n, n) > 0.0 ? normalize(n) : front;
    tangent -= dot(tangent, n) * n; // as fibre_hit.glsl of the path tracer has it
    if (!(dot(tangent, tangent) > 1e-12)) tangent = cross(n, abs(n.x) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0));
    tangent = normalize(tangent);
    vec3 side = cross(front, tangent);
    at.across = dot(side, side) > 1e-12 ? dot(n, normalize(side)) : 0.0;
    at.along = normalize(mat3(u_to_eye) * tangent);
    at.position = (u_to_eye * vec4(p, 1.0)).xyz;
    at.pixels = v_pixels;
    at.radius = radius * length(u_to_eye[0].xyz);
    return true;
}
#endif

// Whether there is one
bool curve_point(out CurvePoint at) {
    at = CurvePoint(v_position, normalize(v_along), clamp(v_across, -1.0, 1.0), v_pixels, v_radius);
#if ROUND == 2
    return round_point(at);
#else
    return true; // the pass before has left out what is not covered
#endif
}
