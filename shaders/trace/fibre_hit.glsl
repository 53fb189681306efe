// The point where a ray hit a curve, read from the scene buffer as viewer/trace/scene/curves.py writes it. Position and
// normal are computed anew from the ray, since hits have only the segment.
#include "trace/hit.glsl"
#include "trace/curve.glsl"
#include "trace/scene_buffer.glsl"
#include "sample/orthonormal_basis.glsl"
#include "bsdf/fibre/fibre.glsl"

uniform int u_curve_points, u_fibres;
#if HAS_FIBRE_COLORS
uniform int u_fibre_absorption; // a texel for each of the points: sigma_a, negative where there is no colour
#endif

struct FibreHit {
    vec3 position; // tracer space
    vec3 n;        // unit, outwards
    mat3 frame;    // the fibre's axis towards its tip, made perpendicular to n; their cross product; n
    vec4 a, b;     // the ends of the segment
    Fibre fibre;
};

// The normal of a segment at a point from the axis: `offset` may have any length
vec3 fibre_normal(vec3 offset, vec3 otherwise) {
    float largest = max(abs(offset.x), max(abs(offset.y), abs(offset.z)));
    return largest > 1e-30 ? normalize(offset / largest) : otherwise;
}

FibreHit fibre_hit(Hit hit, vec3 o, vec3 d) {
    FibreHit f;
    int point = u_curve_points + hit.triangle;
    f.a = scene_float4(point);
    f.b = scene_float4(point + 1);
    vec3 axis = f.b.xyz - f.a.xyz;
    float along, t = segment_entry(o, d, f.a, f.b, along);
    if (t >= 0.5 * NO_ENTRY) { // the ray grazes the segment: it passes where it is nearest
        t = dot(0.5 * (f.a.xyz + f.b.xyz) - o, d) / dot(d, d);
        along = nearest_along(o + t * d, f.a, f.b);
        t += dot(f.a.xyz + along * axis - (o + t * d), d) / dot(d, d);
    }
    vec3 center = along * axis; // from a
    f.n = fibre_normal((o - f.a.xyz) + t * d - center, -d);
    f.position = f.a.xyz + (center + mix(f.a.w, f.b.w, along) * f.n);
    vec3 tangent = fibre_normal(axis, vec3(0.0));
    tangent -= dot(tangent, f.n) * f.n;
    tangent = dot(tangent, tangent) > 1e-12 ? normalize(tangent) : orthonormal_basis(f.n)[0];
    f.frame = mat3(tangent, cross(f.n, tangent), f.n);

    int record = u_fibres + hit.instance * FIBRE_TEXELS;
    vec4 first = scene_float4(record), second = scene_float4(record + 1);
    f.fibre = Fibre(first.rgb, first.w, second.x, second.y, second.z);
#if HAS_FIBRE_COLORS
    vec3 colored = mix(scene_float4(u_fibre_absorption + hit.triangle).rgb,
                       scene_float4(u_fibre_absorption + hit.triangle + 1).rgb, along);
    if (colored.r >= 0.0) f.fibre.sigma_a = colored;
#endif
    return f;
}

// Where a ray begins that leaves in the direction wi from the point of a hit: off the surface, outside for rays
// outwards and inside for rays inwards, which leave the fibre unhindered. What overlaps with the fibre they may hit in
// it.
vec3 leave_fibre(FibreHit f, vec3 wi) {
    float radius = mix(f.a.w, f.b.w, 0.5), off = max(radius / 128.0, 1.0 / 2097152.0);
    return f.position + (dot(wi, f.n) < 0.0 ? -min(off, 0.5 * radius) : off) * f.n;
}
