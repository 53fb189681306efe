// A right-handed orthonormal basis whose third vector is the unit vector n.
// Duff et al. 2017, "Building an Orthonormal Basis, Revisited". They take the sign from copysign; here -0 counts as 0.
mat3 orthonormal_basis(vec3 n) {
    float s = n.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (s + n.z);
    return mat3(vec3(1.0 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x),
                vec3(n.x * n.y * a, s + n.y * n.y * a, -n.y), n);
}

// The unit part of `tangent` that is perpendicular to n; any tangent if there is no such part
vec3 tangent_beside(vec3 n, vec3 tangent) {
    vec3 t = tangent - dot(n, tangent) * n;
    float squared = dot(t, t);
    return squared > 1e-12 * dot(tangent, tangent) ? t * inversesqrt(squared) : orthonormal_basis(n)[0];
}
