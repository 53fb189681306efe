// The point where a ray hit a triangle: position, normals and vertex attributes, read from the scene buffer as
// viewer/trace/scene/encode.py writes it.
#include "trace/hit.glsl"
#include "material/records.glsl"
#include "trace/shading_normal.glsl"
#include "trace/offset_origin.glsl"

uniform int u_instances, u_triangles, u_vertices;

struct Interaction {
    vec3 position;    // tracer space
    vec3 n_geometric; // unit, on the side of wo
    bool is_front;    // wo is on the front side, from which the corners are in counter-clockwise order
    vec3 n;           // shading normal, bent so that wo and its mirror direction are above it and above n_geometric
    vec3 t, b;        // right-handed frame with n; t follows the mesh's tangent where there is one
#if ANISOTROPIC
    vec3 tangent, bitangent; // of the mesh; 0 where it has none
#endif
#if CLEARCOAT
    vec3 n_coat;      // shading normal of the clear coat, bent alike
#endif
    vec2 uv0, uv1;
    vec4 color;       // of the vertices
    int material;
    int flags;        // of the instance
    int medium;       // number of the medium inside, behind the front side
    int emitter;      // number of this triangle among the emitters, or -1
    float area;       // of this triangle, tracer units squared
};

// What the scene buffer has of an instance and of one of its triangles
struct Triangle {
    vec4 row0, row1, row2;  // mesh to tracer space
    int material, first_emitter, flags, medium;
    ivec3 corners;          // texels of the three vertices
    vec3 weights;           // barycentric
};

Triangle find_triangle(Hit hit) {
    int texel = u_instances + hit.instance * INSTANCE_TEXELS;
    uvec4 links = scene_uint4(texel + 3);
    Triangle t;
    t.row0 = scene_float4(texel);
    t.row1 = scene_float4(texel + 1);
    t.row2 = scene_float4(texel + 2);
    t.material = int(links.z);
    t.first_emitter = int(links.w);
    ivec2 inside = ivec2(scene_uint4(texel + 4).xy);
    t.flags = inside.x;
    t.medium = inside.y;
    uvec3 corners = scene_uint4(u_triangles + int(links.x) + hit.triangle).xyz + links.y;
    t.corners = u_vertices + ivec3(corners) * VERTEX_TEXELS;
    t.weights = vec3(1.0 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);
    return t;
}

// Texel number `part` of the vertices, interpolated
vec4 interpolate(Triangle t, int part) {
    return t.weights.x * scene_float4(t.corners.x + part)
         + t.weights.y * scene_float4(t.corners.y + part)
         + t.weights.z * scene_float4(t.corners.z + part);
}

vec3 unit_or(vec3 v, vec3 otherwise) {
    float largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    return largest > 1e-36 ? normalize(v / largest) : otherwise;
}

#if HAS_NORMAL_MAP
// The normal of the normal map with the record `map` - 1, or n if `map` is 0. As raster/normal.glsl.
vec3 mapped_normal(int map, float scale, Interaction i, vec3 along, vec3 across, vec3 n) {
    if (map == 0) return n;
    vec3 texel = sample_atlas(u_data_atlas, texture_map(map - 1, i.uv0, i.uv1)).xyz * (255.0 / 127.5) - 1.0;
    texel.xy *= scale;
    return unit_or(texel.x * along + texel.y * across + texel.z * n, n);
}
#endif

Interaction interact(Hit hit, vec3 wo) {
    Triangle tri = find_triangle(hit);
    vec4 p0 = scene_float4(tri.corners.x), p1 = scene_float4(tri.corners.y), p2 = scene_float4(tri.corners.z);
    vec4 p = tri.weights.x * p0 + tri.weights.y * p1 + tri.weights.z * p2;
    vec4 normal_v = interpolate(tri, 1);

    Interaction i;
    vec4 at = vec4(p.xyz, 1.0);
    i.position = vec3(dot(tri.row0, at), dot(tri.row1, at), dot(tri.row2, at));
    i.material = tri.material;
    i.flags = tri.flags;
    i.medium = tri.medium;
    i.emitter = tri.first_emitter < 0 ? -1 : tri.first_emitter + hit.triangle;
    i.uv0 = vec2(p.w, normal_v.w);
    i.uv1 = vec2(0.0);
#if HAS_UV1
    i.uv1 = interpolate(tri, VERTEX_UV1).xy;
#endif
    i.color = vec4(1.0);
#if HAS_COLOR
    i.color = interpolate(tri, VERTEX_COLOR);
#endif

    float hand = (tri.flags & FLAG_MIRRORED) != 0 ? -1.0 : 1.0;
    mat3 to_tracer = transpose(mat3(tri.row0.xyz, tri.row1.xyz, tri.row2.xyz));
    vec3 edges = cross(to_tracer * (p1.xyz - p0.xyz), to_tracer * (p2.xyz - p0.xyz));
    i.area = 0.5 * length(edges);
    vec3 front = unit_or(hand * edges, wo);
    i.is_front = dot(front, wo) >= 0.0;
    i.n_geometric = i.is_front ? front : -front;

    // The cofactors transform normals. They are the inverse transpose times a factor, and exist for a scale of 0, too.
    vec3 a = tri.row0.xyz, b = tri.row1.xyz, c = tri.row2.xyz;
    vec3 largest3 = max(abs(a), max(abs(b), abs(c)));
    float scale = 1.0 / max(max(largest3.x, max(largest3.y, largest3.z)), 1e-36);
    a *= scale;
    b *= scale;
    c *= scale;
    vec3 stored = normal_v.xyz;
    vec3 n = unit_or(hand * vec3(dot(cross(b, c), stored), dot(cross(c, a), stored), dot(cross(a, b), stored)), front);
#if CLEARCOAT
    vec3 n_coat = n; // the coat does not follow the normal map of what lies below
#endif
#if HAS_TANGENT
    vec4 tangent = interpolate(tri, VERTEX_TANGENT);
    tangent = vec4(to_tracer * tangent.xyz, tangent.w * hand);
    vec3 along = unit_or(tangent.xyz, vec3(0.0));
    vec3 across = cross(n, along) * tangent.w;
#if ANISOTROPIC
    i.tangent = along;
    i.bitangent = across;
#endif
#if HAS_NORMAL_MAP
    vec3 front_n = n;
    n = mapped_normal(int(map_records(i.material).z), normal_scale_factor(i.material), i, along, across, front_n);
#if CLEARCOAT
    n_coat = mapped_normal(int(map_records(i.material).w), clearcoat_normal_scale_factor(i.material), i, along, across,
                           front_n);
#endif
#endif
    i.n = bend_normal(n, i.n_geometric, wo);
    i.t = tangent_beside(i.n, tangent.xyz);
#else
    i.n = bend_normal(n, i.n_geometric, wo);
    i.t = orthonormal_basis(i.n)[0];
#endif
    i.b = cross(i.n, i.t);
#if CLEARCOAT
    i.n_coat = bend_normal(n_coat, i.n_geometric, wo);
#endif
    return i;
}
