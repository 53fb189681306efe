// The geometric normal and the shading normal of a fragment, both on the eye's side of the surface.
in vec3 v_normal;
#if HAS_TANGENT
in vec4 v_tangent;
#endif

vec3 geometric_normal() {
    vec3 n = normalize(v_normal);
#if DOUBLE_SIDED
    if (!gl_FrontFacing) n = -n;
#endif
    return n;
}

vec3 shading_normal(vec3 n) {
#if NORMAL_MAP && HAS_TANGENT
    // Tangent space as in MikkTSpace: bitangent = w cross(n, t), without orthogonalisation of the interpolated vectors.
    vec3 texel = normal_texel().xyz * (255.0 / 127.5) - 1.0;
    texel.xy *= u_normal_scale;
    vec3 t = normalize(v_tangent.xyz);
    vec3 front = normalize(v_normal);
    vec3 b = cross(front, t) * v_tangent.w;
    vec3 mapped = normalize(texel.x * t + texel.y * b + texel.z * front);
#if DOUBLE_SIDED
    if (!gl_FrontFacing) mapped = -mapped;
#endif
    return mapped;
#else
    return n;
#endif
}

#if ANISOTROPIC
// The frame of an anisotropic lobe: the tangent along which highlights are stretched, the bitangent, and n
mat3 anisotropy_frame(MaterialInputs m, vec3 n) {
    vec3 t = normalize(v_tangent.xyz);
    vec3 b = cross(normalize(v_normal), t) * v_tangent.w;
    vec2 d = anisotropy_direction(m);
    vec3 x = d.x * t + d.y * b;
    x -= dot(n, x) * n;
    x *= inversesqrt(max(dot(x, x), 1e-12));
    return mat3(x, cross(n, x), n);
}
#endif
