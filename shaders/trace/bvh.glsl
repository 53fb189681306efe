// Nearest-hit and any-hit queries by traversal of the trees of viewer/trace/rays/bvh.py. A program includes this file
// first, because of the #extension.
//
// The test is watertight: no ray passes through an edge or a corner that triangles share. S. Woop, C. Benthin, I. Wald:
// Watertight Ray/Triangle Intersection, JCGT 2(1), 2013; T. Ize: Robust BVH Ray Traversal, JCGT 2(2), 2013.
#if __VERSION__ < 400
#extension GL_ARB_gpu_shader5 : enable
#endif
#if __VERSION__ >= 400 || defined(GL_ARB_gpu_shader5)
#define PRECISE precise
#else
#define PRECISE
#endif

#include "trace/hit.glsl"
#if HAS_CURVES
#include "trace/curve.glsl"

uniform int u_bvh_curves, u_bvh_points; // as the next ones
#endif

uniform usampler2D u_bvh;
uniform uint u_root;
uniform int u_bvh_triangles, u_bvh_instances; // their first texels

// References, as in viewer/trace/rays/bvh4.py and bvh.py. A reference without the bit LEAF is the number of a node.
const uint LEAF = 1u << 31;                     // | (count - 1) << LEAF_SHIFT | first triangle
const uint INSTANCE = LEAF | 7u << LEAF_SHIFT;  // | number of the instance in this tree
#if HAS_CURVES
const uint CURVES = LEAF | uint(CURVES_SHIFT) << LEAF_SHIFT; // | (count - 1) << LEAF_SHIFT | first curve
#endif
const uint PRIMITIVE_MASK = (1u << LEAF_SHIFT) - 1u;
const uint NOTHING = ~0u;
const float FARTHEST = 16.0; // all geometry is within 1 of the origin, and rays start within about 2 of it

struct Found {
    float t;
    uint code; // kind << KIND_SHIFT | instance
    uint triangle;
    vec2 barycentric;
    uint is_see_through;
};

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
    found = Found(t, bits_b.w, bits_a.w, vec2(v, w) / determinant, bits_c.w);
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
    found = Found(t, link.y, link.x, vec2(0.0), 0u);
    vec4 before = uintBitsToFloat(bvh_texel(point - 1)), after = uintBitsToFloat(bvh_texel(point + 2));
    return !hides(before, a, o + t * d) && !hides(b, after, o + t * d);
}
#endif

#if HAS_SEE_THROUGH
bool shadow_ray_passes(Hit hit, vec3 vector); // trace/see_through.glsl
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

void sort(inout vec4 t, inout uvec4 children, int i, int j) {
    if (t[j] < t[i]) {
        float nearer = t[j];
        uint child = children[j];
        t[j] = t[i];
        children[j] = children[i];
        t[i] = nearer;
        children[i] = child;
    }
}

// Whether the ray o + t d hits a triangle with t in (0, t_max). `nearest` is the nearest such hit. For a shadow ray,
// the first triangle found that stops the ray ends the search. A boundary between media of one index does not stop it.
bool traverse(vec3 o, vec3 d, float t_max, bool is_shadow, out Found nearest) {
    uint stack[STACK]; // references that are still to be visited, and the distances to their boxes
    float stack_t[STACK];
    int count = 0;
    nearest = Found(t_max, MISS, 0u, vec2(0.0), 0u);
    bool is_hit = false;
    PreparedRay ray = prepare(o, d);
#if HAS_INSTANCES
    uvec4 instance = uvec4(NOTHING);
    int outer_count = -1; // size of the stack when the current instance was entered; -1 outside of instances
#endif
    uint next = u_root;
    while (next != NOTHING) {
        if ((next & LEAF) == 0u) {
            vec4 t = intersect_boxes(ray, int(next) * NODE_TEXELS, nearest.t);
            uvec4 children = bvh_texel(int(next) * NODE_TEXELS + 6);
            sort(t, children, 0, 1);
            sort(t, children, 2, 3);
            sort(t, children, 0, 2);
            sort(t, children, 1, 3);
            sort(t, children, 1, 2);
            if (t.w <= FARTHEST) {
                stack_t[count] = t.w;
                stack[count++] = children.w;
            }
            if (t.z <= FARTHEST) {
                stack_t[count] = t.z;
                stack[count++] = children.z;
            }
            if (t.y <= FARTHEST) {
                stack_t[count] = t.y;
                stack[count++] = children.y;
            }
            if (t.x <= FARTHEST) {
                next = children.x;
                continue;
            }
#if HAS_INSTANCES
        } else if (next >= INSTANCE) {
            int texel = u_bvh_instances + int(next & PRIMITIVE_MASK) * BVH_INSTANCE_TEXELS;
            vec4 x = uintBitsToFloat(bvh_texel(texel)), y = uintBitsToFloat(bvh_texel(texel + 1));
            vec4 z = uintBitsToFloat(bvh_texel(texel + 2));
            ray = prepare(vec3(dot(x, vec4(o, 1.0)), dot(y, vec4(o, 1.0)), dot(z, vec4(o, 1.0))),
                         vec3(dot(x.xyz, d), dot(y.xyz, d), dot(z.xyz, d)));
            instance = bvh_texel(texel + 3);
            outer_count = count;
            next = instance.x;
            continue;
#endif
#if HAS_CURVES
        } else if (next >= CURVES) {
            int curve = u_bvh_curves + int(next & PRIMITIVE_MASK);
            int end = curve + int((next - CURVES) >> LEAF_SHIFT) + 1;
            for (; curve < end; ++curve) {
                Found found;
                if (!intersect_curve(o, d, curve, nearest.t, found)) continue;
                nearest = found;
                if (is_shadow) return true;
                is_hit = true;
            }
#endif
        } else {
            int texel = u_bvh_triangles + int(next & PRIMITIVE_MASK) * TRIANGLE_TEXELS;
            int end = texel + TRIANGLE_TEXELS * (int(next >> LEAF_SHIFT & 7u) + 1);
            for (; texel < end; texel += TRIANGLE_TEXELS) {
                Found found;
                if (!intersect_triangle(ray, texel, nearest.t, found)) continue;
#if HAS_INSTANCES
                if (outer_count >= 0) {
                    found.code = instance.y;
                    found.is_see_through = instance.z;
                }
#endif
#if HAS_SEE_THROUGH
                if (is_shadow && found.is_see_through != 0u) {
                    Hit hit = Hit(int(found.code & INSTANCE_MASK), int(found.triangle), found.barycentric);
                    if (shadow_ray_passes(hit, d)) continue;
                }
#endif
#if HAS_SCATTERING
                if (is_shadow && int(found.code >> KIND_SHIFT & 7u) != KIND_BOUNDARY) {
                    nearest = found;
                    return true;
                }
#else
                if (is_shadow) return true;
#endif
                nearest = found;
                is_hit = true;
            }
        }
        while (count > 0 && stack_t[count - 1] >= nearest.t) --count;
        if (count == 0) break;
#if HAS_INSTANCES
        if (count <= outer_count) {
            outer_count = -1;
            ray = prepare(o, d);
        }
#endif
        next = stack[--count];
    }
    return is_hit;
}
