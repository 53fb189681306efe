// A round segment of a curve: the convex hull of two spheres, that is a cone with a sphere at both ends. xyz is the
// centre of a sphere and w its radius. Everything is computed relative to the segment, from the point of the ray that
// is nearest to its middle, so that float32 keeps its digits for a thin fibre and a distant ray.
//
// With y the height of a point along the axis from a, q its vector across the axis, g = (r_a - r_b) / length the sine
// of the cone's half angle and R = r_a - g y, a point is inside of the cone where Q = (1 - g^2) q.q - R^2 < 0, and R >
// 0 on the right side of the apex. The sphere that it touches there has its centre at y - g R / (1 - g^2). (The cone is
// the envelope of the spheres: Q follows from d/dc (|p - c|^2 - r(c)^2) = 0.)
const float NO_ENTRY = 1e30;

struct Segment {
    vec3 axis;    // unit, from a to b; 0 if there is none
    float size;   // the length between the centres
    float slope;  // g; 1 or more if one sphere holds the other
    float square; // 1 - g^2
};

Segment segment_of(vec4 a, vec4 b) {
    vec3 v = b.xyz - a.xyz;
    float largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    if (largest < 1e-30) return Segment(vec3(0.0), 0.0, 2.0, -3.0);
    float size = largest * length(v / largest);
    float slope = (a.w - b.w) / size;
    return Segment(v / size, size, slope, (1.0 - slope) * (1.0 + slope));
}

// Where a ray, from q relative to the centre, enters a sphere
float sphere_entry(vec3 q, vec3 d, float radius) {
    float per = 1.0 / dot(d, d), back = dot(q, d) * per;
    vec3 nearest = q - back * d;
    float inside = (radius - length(nearest)) * (radius + length(nearest));
    return inside >= 0.0 ? -back - sqrt(inside * per) : NO_ENTRY;
}

// The t at which the line o + t d enters the segment, which is negative for a ray that starts inside or behind it, or
// NO_ENTRY. `along` is where on the axis the sphere has its centre that is touched there: 0 at a, 1 at b.
float segment_entry(vec3 o, vec3 d, vec4 a, vec4 b, out float along) {
    Segment s = segment_of(a, b);
    float shift = dot(0.5 * (a.xyz + b.xyz) - o, d) / dot(d, d);
    vec3 from_a = (o - a.xyz) + shift * d;
    vec3 from_b = from_a - (b.xyz - a.xyz);
    float rise = dot(s.axis, d);
    vec3 across = d - rise * s.axis;
    // Q along the ray is A t^2 + 2 B t + C, and the ray enters the cone where Q falls: t = (-B - sqrt(B^2 - A C)) / A.
    float A = s.square * dot(across, across) - s.slope * s.slope * rise * rise;
    float y = dot(s.axis, from_a), R = a.w - s.slope * y;
    vec3 out_of_axis = from_a - y * s.axis;
    float B = s.square * dot(out_of_axis, across) + s.slope * rise * R;
    float t = NO_ENTRY;
    if (s.square > 0.0 && A > 0.01 * dot(d, d)) {
        t = -B / A; // there Q is least, and what is left is a difference of lengths, not of their squares
        y += t * rise;
        R = a.w - s.slope * y;
        float radius = sqrt(s.square) * length(out_of_axis + t * across);
        float inside = (R - radius) * (R + radius);
        along = 0.0;
        if (!(R >= 0.0 && inside >= 0.0)) return NO_ENTRY;
        float half_chord = sqrt(inside / A);
        t -= half_chord;
        y -= half_chord * rise;
    } else if (s.square > 0.0) {
        float radius = sqrt(s.square) * length(out_of_axis);
        float C = (radius - R) * (radius + R), discriminant = B * B - A * C;
        if (discriminant >= 0.0) {
            float root = sqrt(discriminant);
            t = B <= 0.0 ? C / max(root - B, 1e-36) : -(B + root) / A;
            y += t * rise;
        }
    }
    along = (y - s.slope * a.w) / (s.square * s.size);
    if (t < NO_ENTRY && along >= 0.0 && along <= 1.0) return shift + t;
    float first = sphere_entry(from_a, d, a.w), second = sphere_entry(from_b, d, b.w);
    along = first <= second ? 0.0 : 1.0;
    return shift + min(first, second);
}

// The place on the axis of the sphere that comes nearest to p, 0 at a and 1 at b
float nearest_along(vec3 p, vec4 a, vec4 b) {
    Segment s = segment_of(a, b);
    if (s.square <= 0.0) return a.w >= b.w ? 0.0 : 1.0;
    float y = dot(s.axis, p - a.xyz);
    vec3 across = (p - a.xyz) - y * s.axis;
    return clamp((y - s.slope * length(across) * inversesqrt(s.square)) / s.size, 0.0, 1.0);
}

// Whether a segment hides p, a point on the surface of its neighbour, that is holds it, deeper than p is uncertain.
// Where two segments overlap at a joint, a ray in one of them would meet the end of the other from within. A negative
// radius says that there is no neighbour.
bool hides(vec4 a, vec4 b, vec3 p) {
    if (min(a.w, b.w) < 0.0) return false;
    float along = nearest_along(p, a, b), radius = mix(a.w, b.w, along);
    vec3 from_axis = (p - a.xyz) - along * (b.xyz - a.xyz);
    return length(from_axis) < radius - max(radius / 1024.0, 1e-6);
}
