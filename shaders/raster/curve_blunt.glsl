// Segments that a strip does not show well, since they are thick beside their length, turn sharply, taper quickly or
// lie near to the eye beside their radius. They are drawn as what they are, a cone with a sphere at either end, by a
// rectangle in which each fragment meets the cone (curve_point.glsl), by a program of their own (ROUND = 2), since
// fragments that write their depth are all shaded. The other program leaves them out (ROUND = 1).
const float LEAST_ROUND = 3.0; // pixels that such a segment is wide

// As `blunt_radius` in viewer/raster/curve_buffers.py. The sines are those between the segment and the strip's ends.
bool is_blunt(float size, vec2 radii, vec2 sines) {
    return dot(radii, sines) >= 0.8 * size || max(sines.x, sines.y) > 0.4 || abs(radii.x - radii.y) > 0.15 * size;
}

// Whether it is nearer to the eye than 1 / 0.15 of its radius. It then covers 1 % more than this radius says.
bool is_near(vec4 sphere) {
    return sphere.w * length(transpose(u_to_clip)[3].xyz) > 0.15 * (u_to_clip * vec4(sphere.xyz, 1.0)).w;
}

// How far a sphere reaches on the screen, in pixels; negative where it comes too near to the eye to say. A step e moves
// a point by w / w' times its gradient, with w' = w + grad w . e.
float pixels_of_sphere(vec4 sphere) {
    vec3 x, y;
    sight(sphere.xyz, x, y);
    x *= u_half_size.x;
    y *= u_half_size.y;
    float w = (u_to_clip * vec4(sphere.xyz, 1.0)).w;
    float nearest = w - sphere.w * length(transpose(u_to_clip)[3].xyz);
    if (nearest < 0.05 * w || w <= 0.0) return -1.0;
    float a = dot(x, x), b = dot(y, y), c = dot(x, y);
    float steepest = sqrt(0.5 * (a + b) + sqrt(0.25 * (a - b) * (a - b) + c * c));
    return sphere.w * steepest * w / nearest;
}

// A corner of a rectangle on the screen that holds both spheres, in (-1, 1): `end` 0 or 1, `side` from -1 to 1. All of
// the screen where one of them is too near.
vec2 corner_about(vec4 a, vec4 b, int end, float side) {
    float first = pixels_of_sphere(a), second = pixels_of_sphere(b);
    if (first < 0.0 || second < 0.0) return vec2(float(2 * end - 1), side);
    vec4 clip_a = u_to_clip * vec4(a.xyz, 1.0), clip_b = u_to_clip * vec4(b.xyz, 1.0);
    vec2 from = clip_a.xy / clip_a.w * u_half_size, way = clip_b.xy / clip_b.w * u_half_size - from;
    float reach = length(way);
    vec2 along = reach > 1e-3 ? way / reach : vec2(1.0, 0.0);
    float at = end == 0 ? min(-first, reach - second) - 1.0 : max(first, reach + second) + 1.0;
    return (from + along * at + vec2(-along.y, along.x) * (side * (max(first, second) + 1.0))) / u_half_size;
}
