// The two sides of a surface that trace/shade.glsl shades: the frame of the BSDF between them, to which side a
// direction leads, and which medium lies there.

// The side of the surface on which wi lies: 1 for the side of wo, -1 for the other, 0 if no light may go there. That is
// the case for the other side of an opaque surface, and where the shading and the geometric normal disagree about the
// side. A clear coat has a shading normal of its own.
float side_of(Interaction i, vec3 wi, float NoL) {
    float side = dot(wi, i.n_geometric);
#if TRANSMITS
    return side * NoL > 0.0 ? sign(side) : 0.0;
#else
#if CLEARCOAT
    NoL = max(NoL, dot(i.n_coat, wi));
#endif
    return side > 0.0 && NoL > 0.0 ? 1.0 : 0.0;
#endif
}

// Tangent, bitangent and shading normal. For an anisotropic material the tangent is the direction of the stretch.
mat3 shading_frame(Interaction i, MaterialInputs m) {
#if ANISOTROPIC
    vec2 d = anisotropy_direction(m);
    vec3 t = tangent_beside(i.n, d.x * i.tangent + d.y * i.bitangent);
    return mat3(t, cross(i.n, t), i.n);
#else
    return mat3(i.t, i.b, i.n);
#endif
}

// The BSDF for light that leaves by wo; and the frame in which it takes directions, with wo in that frame
Bsdf bsdf_towards(Interaction i, SurfaceMaterial m, vec3 wo, out mat3 frame, out vec3 local_wo) {
    frame = shading_frame(i, m.inputs);
    local_wo = wo * frame;
#if CLEARCOAT
    vec3 n_coat = i.n_coat * frame;
#else
    const vec3 n_coat = vec3(0.0, 0.0, 1.0);
#endif
    Bsdf b = bsdf_at(i, m, local_wo, n_coat);
#if GUIDED
    b.guide = guide_at(i.position, frame, roughly_reflected(b));
#endif
    return b;
}

// The number of the medium, or the nesting of media, on a side of the surface, as side_of gives it
int medium_at(Path p, Interaction i, SurfaceMaterial m, float side) {
#if TRANSMITS
#if HAS_SCATTERING || HAS_NESTED
    if (side < 0.0 && !m.is_thin) return cross_boundary(p.medium, i.medium, i.is_front);
#else
    if (side < 0.0 && !m.is_thin) return i.is_front ? i.medium : 0;
#endif
#endif
    return p.medium;
}
