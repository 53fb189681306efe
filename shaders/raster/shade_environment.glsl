// A surface of pbr.frag under what shines from all around, the environment and other surfaces: the split sum, each of
// its parts looked up on its own.

#include "raster/specular_occlusion.glsl"
#if INDIRECT
#include "raster/indirect.glsl"
#endif

#if HAS_ENVIRONMENT && REFLECTS
// The environment about the mirror direction of a facet whose normal is h, between h and that direction by t
vec3 reflected_along(Point p, vec3 h, float t, float perceptual_roughness) {
    vec3 d = mix(h, reflect(-p.v, h), t);
    // A mapped normal may send the reflection under the surface, where it would meet the surface itself.
    d -= 2.0 * min(dot(d, p.n_geometric), 0.0) * p.n_geometric;
    return environment_specular(normalize(d), perceptual_roughness);
}

#if ANISOTROPIC
// The anisotropic lobe as a weighted sum of STRETCHED_LOBES narrower isotropic lobes. Their facets are tilted along the
// tangent with the slopes x of a GGX distribution of width a, whose cumulative distribution is
// (1 + x / sqrt(a^2 + x^2)) / 2 (Walter et al. 2007; Heitz 2014). a^2 = alpha_t^2 - alpha_narrow^2 is the width that the
// narrow lobes lack. A lobe's weight is the projected area of its facets towards the eye times their shadowing, G1(l).
vec3 stretched_reflection(Point p, Surface s) {
    vec2 alpha = both_alphas(s);
    float alpha_narrow = max(alpha.y, 0.5 * alpha.x / float(STRETCHED_LOBES)); // so that neighbouring lobes overlap
    SplitSum narrow = dfg_lookup(u_dfg, p.NoV, sqrt(alpha_narrow));
    float a = sqrt(max(alpha.x * alpha.x - alpha_narrow * alpha_narrow, 0.0));
    vec3 sum = vec3(0.0);
    float weights = 0.0;
    for (int k = 0; k < STRETCHED_LOBES; ++k) {
        float q = (2.0 * float(k) + 1.0) / float(STRETCHED_LOBES) - 1.0;
        vec3 facet = p.n + (a * q * inversesqrt(1.0 - q * q)) * p.frame[0];
        vec3 h = normalize(facet);
        vec3 l = reflect(-p.v, h) * p.frame;
        float weight = max(dot(p.v, facet), 0.0) * max(l.z, 0.0) / (max(l.z, 0.0) + smith_t(l, alpha));
        sum += weight * reflected_along(p, h, narrow.t.x, narrow.roughness.x);
        weights += weight;
    }
    return sum / max(weights, 1e-6);
}
#endif
#endif

vec3 shade_environment(Point p, Surface s, SurfaceView view, float occlusion, vec4 visible, SplitSum split_sum) {
    mat2x3 specular = mat2x3(0.0);
    vec3 mean_light = vec3(0.0);
#if HAS_ENVIRONMENT
#if REFLECTS
#if ANISOTROPIC
    specular[0] = specular[1] = stretched_reflection(p, s);
#elif METALNESS == 1
    vec2 both = common_look_up(split_sum, max3(view.metal.f0)); // of a metal b is a small part
    specular[0] = specular[1] = reflected_along(p, p.n, both.x, both.y);
#else
    specular[0] = reflected_along(p, p.n, split_sum.t.x, split_sum.roughness.x);
    specular[1] = reflected_along(p, p.n, split_sum.t.y, split_sum.roughness.y);
#endif
#endif
    mean_light = environment_irradiance_over_pi(p.n);
#endif
#if TRACED_REFLECTION
    mat2x3 open = specular; // what nothing hides
#endif
#if OCCLUSION_MAP
    mean_light *= occlusion;
    specular *= specular_occlusion(p.NoV, occlusion, mean_alpha(s));
#endif
#if VISIBILITY
    mean_light *= visible.rgb;
    specular *= visible.a;
#endif
#if INDIRECT
    add_indirect(p.NoV, mean_alpha(s), specular, mean_light);
#endif
#if TRACED_REFLECTION
    vec4 met = traced_reflection(v_position, p.n_geometric);
    float traced = traced_share(view.perceptual_roughness);
    for (int k = 0; k < 2; ++k) specular[k] = mix(specular[k], (1.0 - met.a) * open[k] + met.rgb, traced);
#endif
#if TRACED_REFRACTION
    vec4 mirrored = traced_light(u_mirrored, p.n_geometric);
    float share = mirrored.a >= 0.0 ? 1.0 - smoothstep(0.2, 0.5, view.perceptual_roughness) : 0.0; // of a lobe one ray is
    for (int k = 0; k < 2; ++k) specular[k] = mix(specular[k], mirrored.rgb, share);
#endif
    return surface_environment(s, view, specular, mean_light);
}
