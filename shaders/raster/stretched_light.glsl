// What a stretched lobe reflects of the environment, for shade_environment.glsl.

// The anisotropic lobe as a weighted sum of LOOKUPS narrower isotropic lobes. Their facets are tilted along the
// tangent with the slopes x of a GGX distribution of width a, whose cumulative distribution is
// (1 + x / sqrt(a^2 + x^2)) / 2 (Walter et al. 2007; Heitz 2014). a^2 = alpha_t^2 - alpha_narrow^2 is the width that
// the narrow lobes lack. A lobe's weight is the projected area of its facets towards the eye times their shadowing,
// G1(l).
mat2x3 stretched_light(Point p, Surface s, vec3 around) {
    vec2 alpha = both_alphas(s);
    float alpha_narrow = max(alpha.y, 0.5 * alpha.x / float(LOOKUPS)); // so that neighbouring lobes overlap
    vec4 narrow = lobe_lookup(u_dfg, p.NoV, sqrt(alpha_narrow), 1);
    float a = sqrt(max(alpha.x * alpha.x - alpha_narrow * alpha_narrow, 0.0));
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int k = 0; k < LOOKUPS; ++k) {
        float q = (2.0 * float(k) + 1.0) / float(LOOKUPS) - 1.0;
        vec3 facet = p.n + (a * q * inversesqrt(1.0 - q * q)) * p.frame[0];
        vec3 h = normalize(facet);
        vec3 l = reflect(-p.v, h) * p.frame;
        float weight = max(dot(p.v, facet), 0.0) * max(l.z, 0.0) / max(max(l.z, 0.0) + smith_t(l, alpha), 1e-6);
        sum += weight * environment_level(reflected_direction(p, h, narrow.x), narrow.y);
        weights += weight;
    }
    return outerProduct(sum / max(weights, 1e-6), narrow.zw) + outerProduct(around, 1.0 - narrow.zw);
}
