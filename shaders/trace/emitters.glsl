// Points on emissive triangles, uniform by area. An emitter is one texel of the scene buffer: instance,
// triangle, way through the tree of lights (trace/light_tree.glsl), and whether it is there.
#include "trace/emission.glsl"

uniform int u_emitters;

// Samples a point of emitter k for the receiving point p. Returns the radiance that arrives from there. `pdf` is its
// density by solid angle, 0 if the side that faces p does not emit.
vec3 sample_emitter(int k, vec3 p, vec2 u, out vec3 l, out float distance, out float pdf) {
    // Heitz 2019, "A Low-Distortion Map Between Triangle and Square": folds one half of the square onto the other
    vec2 barycentric = u.y > u.x ? vec2(0.5 * u.x, u.y - 0.5 * u.x) : vec2(u.x - 0.5 * u.y, 0.5 * u.y);
    uvec4 record = scene_uint4(u_emitters + k);
    Hit hit = Hit(int(record.x), int(record.y), barycentric);
    Triangle tri = find_triangle(hit);
    vec3 p0 = scene_float4(tri.corners.x).xyz, p1 = scene_float4(tri.corners.y).xyz;
    vec3 p2 = scene_float4(tri.corners.z).xyz;
    mat3 to_tracer = transpose(mat3(tri.row0.xyz, tri.row1.xyz, tri.row2.xyz));
    vec3 to_light = to_tracer * (tri.weights.x * p0 + tri.weights.y * p1 + tri.weights.z * p2)
                  + vec3(tri.row0.w, tri.row1.w, tri.row2.w) - p;
    vec3 normal = cross(to_tracer * (p1 - p0), to_tracer * (p2 - p0)); // its length is twice the area
    if ((tri.flags & FLAG_MIRRORED) != 0) normal = -normal;
    distance = length(to_light);
    l = to_light / max(distance, 1e-30);
    float facing = -dot(normal, l); // 2 A cos
    if ((tri.flags & FLAG_DOUBLE_SIDED) != 0) facing = abs(facing);
    pdf = facing > 0.0 ? 2.0 * distance * distance / facing : 0.0; // d^2 / (A cos)
    if (pdf == 0.0) return vec3(0.0);
    vec3 radiance = emission_towards(hit, -l);
#if HAS_SEE_THROUGH
    radiance *= coverage_at(hit);
#endif
    return radiance;
}
