// Nearest-hit and any-hit queries by traversal of the trees of viewer/trace/rays/bvh.py. A program includes this file
// first, because of the #extension.
#if __VERSION__ < 400
#extension GL_ARB_gpu_shader5 : enable
#endif
#if __VERSION__ >= 400 || defined(GL_ARB_gpu_shader5)
#define PRECISE precise
#else
#define PRECISE
#endif

#include "trace/hit.glsl"
#include "trace/bvh_tests.glsl"

uniform uint u_root;
uniform int u_bvh_triangles, u_bvh_instances; // their first texels
#if HAS_CURVES
uniform int u_bvh_curves; // as well
#endif

// References, as in viewer/trace/rays/bvh4.py and bvh.py. A reference without the bit LEAF is the number of a node.
const uint LEAF = 1u << 31;                     // | (count - 1) << LEAF_SHIFT | first triangle
const uint INSTANCE = LEAF | 7u << LEAF_SHIFT;  // | number of the instance in this tree
#if HAS_CURVES
const uint CURVES = LEAF | uint(CURVES_SHIFT) << LEAF_SHIFT; // | (count - 1) << LEAF_SHIFT | first curve
#endif
const uint PRIMITIVE_MASK = (1u << LEAF_SHIFT) - 1u;
const uint NOTHING = ~0u;

#if HAS_SEE_THROUGH
bool shadow_ray_passes(Hit hit, vec3 vector); // trace/see_through.glsl
#endif

#if HAS_SCATTERING || HAS_PANES
bool is_boundary(Found found) {
    return int(found.code >> KIND_SHIFT & 7u) == KIND_BOUNDARY;
}

// Whether what was found may let a part of a shadow ray's light on (trace/shadow_transmittance.glsl)
bool takes_part(Found found) {
    return is_boundary(found) || (found.flags & IS_PANE) != 0u;
}
#endif

// Whether shadow rays go to the camera, whose rays pass the backs of single-sided surfaces: these come to the fronts.
uniform bool u_sees_backs;

bool leaves_by_back(Found found) {
    return (found.flags & HAS_OPEN_BACK) != 0u && found.is_front != ((found.flags & IS_MIRRORED) != 0u);
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
// the first triangle found that stops the ray ends the search. Boundaries between media of one index and panes do not.
bool traverse(vec3 o, vec3 d, float t_max, bool is_shadow, out Found nearest) {
    uint stack[STACK]; // references that are still to be visited, and the distances to their boxes
    float stack_t[STACK];
    int count = 0;
    nearest = Found(t_max, MISS, 0u, vec2(0.0), 0u, true);
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
                    found.flags = instance.z;
                }
#endif
                if (is_shadow && u_sees_backs && leaves_by_back(found)) continue;
#if HAS_SEE_THROUGH
                if (is_shadow && (found.flags & IS_SEE_THROUGH) != 0u) {
                    Hit hit = Hit(int(found.code & INSTANCE_MASK), int(found.triangle), found.barycentric);
                    if (shadow_ray_passes(hit, d)) continue;
                }
#endif
#if HAS_SCATTERING || HAS_PANES
                if (is_shadow && !takes_part(found)) {
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
