// The reflectance of glass. It is the exact one, as in the path tracer, and on a thin wall that of both faces with all
// reflections between them, R' = 2 R / (1 + R). The albedo table contains Schlick's curve, f0 + (f90 - f0) w, which for
// f0 = R'(0) is too low by a third at the rims of thin walls. So f0 and f90 become those of a curve that meets the exact
// reflectance at the angle of view: with a higher f0, or with f0 = 0 and a lower f90. Facets that a lamp
// lights are seen at other angles, so raster/pbr.frag keeps Schlick's curve for them.

// Of both faces of a thin wall together
vec3 of_both_faces(vec3 F) {
#if !IS_SOLID
    F = 2.0 * F / (1.0 + F);
#endif
    return F;
}

// dfg: (a, b) of the split sum. b / (a + b) is the mean of w over the facets that are seen; mu is the angle to it.
void reflect_as_glass(inout Surface s, float transmission, vec2 dfg) {
    float w = dfg.y / max(dfg.x + dfg.y, 1e-6), mu = 1.0 - pow(w, 0.2);
    vec3 F = of_both_faces(mix(s.f0, vec3(s.f90), exact_fresnel_weight(mu, s.ior)));
    vec3 f0 = max((F - w * s.f90) / max(1.0 - w, 1e-6), 0.0);
    s.f0 = mix(s.f0, f0, transmission);
    s.f90 = mix(s.f90, min(max3(F) / max(w, 1e-6), s.f90), transmission);
}
