// A strip that faces the viewer (or the light, in shadow maps) along each segment of a curve. A segment is an instance,
// and has u_columns pairs of vertices across, the middle ones nearer to the viewer, as on a tube. Strips share their
// ends with their neighbours. At both ends of a strand they go on by its radius, for the round end.
#if YARN
#include "raster/yarn_points.glsl"
out vec3 v_yarn;         // from the yarn's axis to the strand's, in radii of the yarn
out vec3 v_yarn_along;   // along the yarn
out float v_yarn_radius; // in eye-relative units
#else
uniform sampler2D u_points; // x, y, z and radius of one point after the other; the sign of the radius marks the last
#endif
#if HAS_COLORS
uniform sampler2D u_colors; // absorption at each point
out vec3 v_sigma_a;
#endif
#include "raster/curve_sight.glsl"
#if ROUND
#include "raster/curve_blunt.glsl"
#if ROUND == 2
out vec2 v_screen;           // place on the screen, in (-1, 1)
flat out vec4 v_a, v_b;      // the ends of the segment and their radii
flat out vec3 v_along_a, v_along_b; // the curve's direction at both, which its neighbours share
#endif
#endif
uniform mat4 u_to_eye;       // to eye-relative space
uniform float u_least_width; // in pixels: thinner strips are widened to it and cover a share of it
uniform int u_columns;

out vec3 v_position;          // eye-relative
out vec3 v_along;             // along the curve, root to tip
out float v_across;           // -1 to 1
out vec2 v_beyond;            // how far it lies beyond the root and the tip of a strand, in radii
out float v_share;            // what the curve covers of the strip
out float v_pixels;           // width of the curve in pixels
out float v_radius;           // in eye-relative units
flat out uint v_number;       // of the segment
invariant gl_Position;

#if !YARN
vec4 point(int k) {
    return texelFetch(u_points, ivec2(k & (POINTS_WIDTH - 1), k / POINTS_WIDTH), 0);
}
#endif

bool is_last(vec4 p) {
    return (floatBitsToUint(p.w) & 0x80000000u) != 0u;
}

vec3 any_across(vec3 d) {
    return normalize(cross(d, abs(d.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0)));
}

// The direction of a strip at an end of segment k which is not the strand's: the mean of both segments, which share it
vec3 along_at(int k, int end, vec3 axis) {
    vec3 other = end == 0 ? point(k).xyz - point(k - 1).xyz : point(k + 2).xyz - point(k + 1).xyz;
    if (dot(other, other) == 0.0) return axis;
    vec3 mean = axis + normalize(other);
    return dot(mean, mean) > 0.5 ? normalize(mean) : axis; // not round a hairpin
}

#if ROUND
// The sine between the axis of segment k and that direction; 1 round a hairpin
float sine_at(int k, int end, vec3 axis) {
    vec3 along = along_at(k, end, axis);
    vec3 other = end == 0 ? point(k).xyz - point(k - 1).xyz : point(k + 2).xyz - point(k + 1).xyz;
    return along == axis && dot(axis, other) < 0.0 ? 1.0 : length(cross(axis, along));
}
#endif

// The direction that is shaded at an end, of a segment which leaves its ends along `here` and `there`. A thin curve has
// that of the segment: means of neighbours turn less than the curve does, and a wavy strand would catch other light.
// Where segments can be told apart, it turns as fast as at the ends, but about that of the segment.
vec3 shaded_along(vec3 axis, vec3 here, vec3 there, float pixels) {
    return axis + 0.5 * smoothstep(1.5, 3.0, pixels) * (here - there);
}

void main() {
    int k = gl_InstanceID, end = gl_VertexID & 1;
    v_number = uint(k);
#if YARN
    g_strand = k % u_shown.y;
    k = u_shown.x + k / u_shown.y;
    v_number = uint(k * u_shown.y + g_strand);
    v_yarn = v_yarn_along = vec3(0.0);
    v_yarn_radius = 0.0;
#endif
    vec4 here = point(k), next = point(k + 1);
    gl_Position = vec4(0.0, 0.0, 0.0, -1.0); // clipped
    v_position = v_along = vec3(0.0);
    v_across = v_share = v_pixels = v_radius = 0.0;
    v_beyond = vec2(-1.0);
#if ROUND == 2
    v_screen = vec2(0.0);
    v_a = v_b = vec4(0.0);
    v_along_a = v_along_b = vec3(0.0);
#endif
#if HAS_COLORS
    ivec2 at = ivec2((k + end) & (POINTS_WIDTH - 1), (k + end) / POINTS_WIDTH);
    v_sigma_a = texelFetch(u_colors, at, 0).rgb;
#endif
    if (is_last(here)) return;

    vec4 p = end == 0 ? here : next;
    vec3 chord = next.xyz - here.xyz;
    vec3 axis = dot(chord, chord) > 0.0 ? normalize(chord) : vec3(0.0, 0.0, 1.0);
    bvec2 is_tip = bvec2(k == 0 || is_last(point(max(k - 1, 0))), is_last(next));
    vec3 along = is_tip[end] ? axis : along_at(k, end, axis);
    vec3 along_there = is_tip[1 - end] ? axis : along_at(k, 1 - end, axis);
    float radius = abs(p.w);
    vec3 gradient_x, gradient_y;
    vec3 front = sight(p.xyz, gradient_x, gradient_y);
    vec3 side = cross(front, along);
    side = dot(side, side) > 1e-8 ? normalize(side) : any_across(front);

    // The radius in pixels, and the strip's half width in units
    vec2 pixels = vec2(dot(gradient_x, side), dot(gradient_y, side)) * u_half_size;
    float per_unit = max(length(pixels), 1e-30);
    v_pixels = 2.0 * radius * per_unit;
    float half_width = max(radius, 0.5 * u_least_width / per_unit);
    v_share = radius / half_width;
    v_radius = radius * length(u_to_eye[0].xyz);

    float a = 2.0 * float(gl_VertexID >> 1) / float(u_columns - 1) - 1.0;
    // The half of the sphere about p that faces the viewer: a step towards the viewer moves nothing on the screen. One
    // across the curve would move the strip along a curve that is seen at a slant.
    vec3 q = p.xyz + side * (half_width * a) + front * (radius * sqrt(max(1.0 - a * a, 0.0)));
    if (is_tip[end]) {
        vec3 beyond = along - front * dot(along, front);
        beyond = dot(beyond, beyond) > 1e-8 ? normalize(beyond) : normalize(cross(side, front));
        q += beyond * (end == 0 ? -radius : radius);
    }
    float reach = length(chord - front * dot(chord, front)) / max(radius, 1e-30);
    if (is_tip.x) v_beyond.x = end == 0 ? 1.0 : -reach - float(is_tip.y);
    if (is_tip.y) v_beyond.y = end == 1 ? 1.0 : -reach - float(is_tip.x);
    v_across = a;
    v_along = mat3(u_to_eye) * shaded_along(axis, along, along_there, v_pixels);
#if YARN
    vec4 center = axis_texel(k + end, 0);
    v_yarn_radius = abs(center.w) * length(u_to_eye[0].xyz);
    v_yarn = mat3(u_to_eye) * (p.xyz - center.xyz) / max(v_yarn_radius, 1e-30);
    v_yarn_along = mat3(u_to_eye) * cross(axis_texel(k + end, 1).xyz, axis_texel(k + end, 2).xyz);
#endif
    v_position = (u_to_eye * vec4(q, 1.0)).xyz;
    gl_Position = u_to_clip * vec4(q, 1.0);
#if ROUND
    vec4 first = here, second = vec4(next.xyz, abs(next.w));
    vec2 sines = vec2(is_tip.x ? 0.0 : sine_at(k, 0, axis), is_tip.y ? 0.0 : sine_at(k, 1, axis));
    float widest = 2.0 * max(pixels_of_sphere(first), pixels_of_sphere(second));
    bool is_round = is_blunt(length(chord), vec2(first.w, second.w), sines) || is_near(first) || is_near(second);
    is_round = is_round && !(widest >= 0.0 && widest < LEAST_ROUND);
#if ROUND == 1
    if (is_round) gl_Position = vec4(0.0, 0.0, 0.0, -1.0);
#else
    bool is_sphere = dot(chord, chord) == 0.0;
    v_a = first;
    v_b = second;
    vec3 first_along = end == 0 ? along : along_there, second_along = end == 0 ? along_there : along;
    v_along_a = v_along_b = axis;
    if (is_sphere && !is_tip.y && point(k + 2).xyz != next.xyz)
        v_along_a = v_along_b = normalize(point(k + 2).xyz - next.xyz);
    if (!is_sphere) {
        v_along_a = shaded_along(axis, first_along, second_along, v_pixels);
        v_along_b = shaded_along(axis, second_along, first_along, v_pixels);
    }
    v_share = 1.0;
    v_beyond = vec2(-1.0);
    v_screen = corner_about(v_a, v_b, end, a);
    bool is_shown = is_round && (is_tip.x || !is_sphere); // the segment before a sphere shows it
    gl_Position = vec4(v_screen, 0.5, is_shown ? 1.0 : -1.0);
#endif
#endif
}
