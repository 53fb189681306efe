// The geometric normal and the shading normal of a fragment, both on the eye's side of the surface.
#include "raster/varying.glsl"
VARYING vec3 v_normal;
#if HAS_TANGENT
VARYING vec4 v_tangent;

// Zero where the model matrix flattens the tangent
vec3 mesh_tangent() {
    return v_tangent.xyz * inversesqrt(max(dot(v_tangent.xyz, v_tangent.xyz), 1e-36));
}
#endif
#if ANISOTROPIC
#include "sample/orthonormal_basis.glsl"
#endif

// Perpendicular to the triangle, on its front
vec3 across_triangle() {
#if DEFERRED
    return deferred_face;
#else
    vec3 towards_eye = cross(dFdx(v_position), dFdy(v_position));
    return gl_FrontFacing ? towards_eye : -towards_eye;
#endif
}

// The normal of the vertices, on the front; that of the triangle where they have none, or theirs cancel
vec3 front_normal() {
    vec3 across = across_triangle();
    return normalize(dot(v_normal, v_normal) > 1e-36 ? v_normal : across);
}

vec3 geometric_normal() {
    vec3 n = front_normal();
#if DOUBLE_SIDED
    if (!IS_FRONT) n = -n;
#endif
    return n;
}

#if (NORMAL_MAP || CLEARCOAT_NORMAL_MAP) && HAS_TANGENT
#include "trace/shading_normal.glsl"

// The normal n of a map as paths bend it: the mirror direction of v is above the triangle. Where the map is blank, since
// materials share a program, n is as without one.
vec3 bent_over_triangle(vec3 n, vec3 n_geometric, vec3 v) {
    if (distance(n, n_geometric) < 1e-5) return n;
    vec3 face = across_triangle();
    face *= sign(dot(face, v)) / max(length(face), 1e-30);
    return bend_normal(n, face == vec3(0.0) ? n_geometric : face, v);
}

// Tangent space as in MikkTSpace: bitangent = w cross(n, t), without orthogonalisation of the interpolated vectors.
mat3 map_axes() {
    vec3 t = mesh_tangent();
    vec3 front = front_normal();
    return mat3(t, cross(front, t) * v_tangent.w, front);
}

// The normal of a texel of a normal map
vec3 mapped_normal(vec3 texel, float scale) {
    texel = texel * (255.0 / 127.5) - 1.0;
    texel.xy *= scale;
    mat3 axes = map_axes();
    vec3 mapped = normalize(texel.x * axes[0] + texel.y * axes[1] + texel.z * axes[2]);
#if DOUBLE_SIDED
    if (!IS_FRONT) mapped = -mapped;
#endif
    return mapped;
}
#endif

vec3 shading_normal(vec3 n) {
#if NORMAL_MAP && HAS_TANGENT
    return mapped_normal(normal_texel().xyz, u_normal_scale);
#else
    return n;
#endif
}

#if CLEARCOAT
// The coat does not follow the normal map of what lies below.
vec3 coat_normal(vec3 n) {
#if CLEARCOAT_NORMAL_MAP && HAS_TANGENT
    return mapped_normal(clearcoat_normal_texel().xyz, u_clearcoat_normal_scale);
#else
    return n;
#endif
}
#endif

#if ANISOTROPIC
// The frame of an anisotropic lobe: the tangent along which highlights are stretched, the bitangent, and n
mat3 anisotropy_frame(MaterialInputs m, vec3 n) {
    vec3 t = mesh_tangent();
    vec3 b = cross(front_normal(), t) * v_tangent.w;
    vec2 d = anisotropy_direction(m);
    vec3 x = tangent_beside(n, d.x * t + d.y * b);
    return mat3(x, cross(n, x), n);
}
#endif
