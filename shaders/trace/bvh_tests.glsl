// Tests of a ray against what the nodes and leaves of bvh.glsl hold: boxes, triangles, and segments of curves.
//
// The test of triangles is watertight: no ray passes through an edge or a corner that they share. S. Woop, C. Benthin,
// I. Wald: Watertight Ray/Triangle Intersection, JCGT 2(1), 2013; T. Ize: Robust BVH Ray Traversal, JCGT 2(2), 2013.
#if HAS_CURVES
#include "trace/curve.glsl"

uniform int u_bvh_points; // the first texel of the points of curves
#endif

uniform usampler2D u_bvh;

const float FARTHEST = 16.0; // all geometry is within 1 of the origin, and rays start within about 2 of it

struct Found {
    float t;
    uint code; // kind << KIND_SHIFT | instance
    uint triangle;
    vec2 barycentric;
    uint flags;    // of the triangle, below
    bool is_front; // its corners are in counter-clockwise order, seen from the ray's origin
};

// As viewer/trace/rays/bvh.py
const uint IS_SEE_THROUGH = 1u, HAS_OPEN_BACK = 2u, IS_MIRRORED = 4u, IS_PANE = 8u;

// A ray with what the intersection tests need
struct PreparedRay {
    vec3 origin;
    vec3 inverse; // 1 / direction
    int axis;     // of the direction's largest component
    vec3 shear;   // maps the direction to the unit vector along that axis
};

uvec4 bvh_texel(int i) {
    return texelFetch(u_bvh, ivec2(i & (BVH_WIDTH - 1), i / BVH_WIDTH), 0);
}

// Rotates the components of v so that `axis` comes last
vec3 axis_last(vec3 v, int axis) {
    return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v;
}

PreparedRay prepare(vec3 origin, vec3 direction) {
    vec3 size = abs(direction);
    int axis = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    // A component of exactly 0 would give 0 * infinity, which is NaN, where the origin lies on a side of a box.
    vec3 nonzero = mix(direction, vec3(1e-20), lessThan(size, vec3(1e-20)));
    vec3 d = axis_last(direction, axis);
    return PreparedRay(origin, 1.0 / nonzero, axis, vec3(d.xy, 1.0) / d.z);
}

// `precise` makes the two triangles of an edge round their products alike. Otherwise the edge would have a gap.
bool intersect_triangle(PreparedRay ray, int texel, float t_max, out Found found) {
    uvec4 bits_a = bvh_texel(texel), bits_b = bvh_texel(texel + 1), bits_c = bvh_texel(texel + 2);
    vec3 a = axis_last(uintBitsToFloat(bits_a.xyz) - ray.origin, ray.axis);
    vec3 b = axis_last(uintBitsToFloat(bits_b.xyz) - ray.origin, ray.axis);
    vec3 c = axis_last(uintBitsToFloat(bits_c.xyz) - ray.origin, ray.axis);
    PRECISE vec2 a2 = a.xy - ray.shear.xy * a.z;
    PRECISE vec2 b2 = b.xy - ray.shear.xy * b.z;
    PRECISE vec2 c2 = c.xy - ray.shear.xy * c.z;
    PRECISE float u = c2.x * b2.y - c2.y * b2.x;
    PRECISE float v = a2.x * c2.y - a2.y * c2.x;
    PRECISE float w = b2.x * a2.y - b2.y * a2.x;
    float determinant = u + v + w;
    float t = ray.shear.z * (u * a.z + v * b.z + w * c.z) / determinant;
    found = Found(t, bits_b.w, bits_a.w, vec2(v, w) / determinant, bits_c.w, determinant * ray.shear.z > 0.0);
    bool is_inside = !(min(u, min(v, w)) < 0.0 && max(u, max(v, w)) > 0.0);
    return is_inside && determinant != 0.0 && t > 0.0 && t < t_max;
}

#if HAS_CURVES
bool intersect_curve(vec3 o, vec3 d, int texel, float t_max, out Found found) {
    uvec4 link = bvh_texel(texel);
    int point = u_bvh_points + int(link.x);
    vec4 a = uintBitsToFloat(bvh_texel(point)), b = uintBitsToFloat(bvh_texel(point + 1));
    float along, t = segment_entry(o, d, a, b, along);
    if (!(t > 0.0 && t < t_max)) return false;
    found = Found(t, link.y, link.x, vec2(0.0), 0u, true);
    vec4 before = uintBitsToFloat(bvh_texel(point - 1)), after = uintBitsToFloat(bvh_texel(point + 2));
    return !hides(before, a, o + t * d) && !hides(b, after, o + t * d);
}
#endif

// Distances to the boxes of a node's four children; more than FARTHEST where the ray misses the box.
vec4 intersect_boxes(PreparedRay ray, int texel, float t_max) {
    vec4 near = vec4(0.0), far = vec4(t_max);
    for (int axis = 0; axis < 3; ++axis) {
        vec4 a = (uintBitsToFloat(bvh_texel(texel + 2 * axis)) - ray.origin[axis]) * ray.inverse[axis];
        vec4 b = (uintBitsToFloat(bvh_texel(texel + 2 * axis + 1)) - ray.origin[axis]) * ray.inverse[axis];
        near = max(near, min(a, b));
        far = min(far, max(a, b) * (1.0 + 1.0 / 1048576.0)); // larger than the rounding error
    }
    return mix(near, vec4(2.0 * FARTHEST), greaterThan(near, far));
}
