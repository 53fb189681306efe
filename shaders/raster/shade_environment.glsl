// A surface of pbr.frag under what shines from all around, the environment and other surfaces: the split sum, each of
// its parts looked up on its own.

#include "raster/specular_occlusion.glsl"
#if INDIRECT
#include "raster/indirect.glsl"
#endif

// Light reflected at the interface, `specular` the radiance its parts a and b see, and what passes through to the base.
vec3 environment_response(Interface face, SplitSum split_sum, mat2x3 specular, vec3 diffuse_albedo, vec3 mean_light) {
    vec3 single = face.f0 * (split_sum.albedo.x * specular[0]) + face.f90 * (split_sum.albedo.y * specular[1]);
    vec3 diffuse = diffuse_albedo * max(1.0 - max3(face.E_ss + face.E_ms), 0.0); // < 0 without masking
    vec3 spread = face.E_ms * float(SHOW_MULTISCATTER) + diffuse * float(SHOW_DIFFUSE);
    return single * float(SHOW_SPECULAR) + mean_light * spread;
}

#if HAS_ENVIRONMENT && REFLECTS
vec3 reflected_light(vec3 n, vec3 r, vec3 n_geometric, float t, float perceptual_roughness) {
    vec3 d = mix(n, r, t);
    // A mapped normal may send the reflection under the surface, where it would meet the surface itself.
    d -= 2.0 * min(dot(d, n_geometric), 0.0) * n_geometric;
    return environment_specular(normalize(d), perceptual_roughness);
}
#endif

vec3 shade_environment(Surface s, vec3 n_geometric, float occlusion, vec4 visible, SplitSum split_sum) {
    mat2x3 specular = mat2x3(0.0);
    vec3 mean_light = vec3(0.0);
#if HAS_ENVIRONMENT
#if REFLECTS
    vec3 r = reflect(-s.v, s.n);
#if METALNESS == 1
    vec2 both = common_look_up(split_sum, max3(s.metal.f0)); // of a metal b is a small part
    specular[0] = specular[1] = reflected_light(s.n, r, n_geometric, both.x, both.y);
#else
    specular[0] = reflected_light(s.n, r, n_geometric, split_sum.t.x, split_sum.roughness.x);
    specular[1] = reflected_light(s.n, r, n_geometric, split_sum.t.y, split_sum.roughness.y);
#endif
#endif
    mean_light = environment_irradiance_over_pi(s.n);
#endif
#if TRACED_REFLECTION
    mat2x3 open = specular; // what nothing hides
#endif
#if OCCLUSION_MAP
    mean_light *= occlusion;
    specular *= specular_occlusion(s.NoV, occlusion, s.alpha);
#endif
#if VISIBILITY
    mean_light *= visible.rgb;
    specular *= visible.a;
#endif
#if INDIRECT
    add_indirect(s.NoV, s.alpha, specular, mean_light);
#endif
#if TRACED_REFLECTION
    vec4 met = traced_reflection(v_position, n_geometric);
    float traced = traced_share(s.perceptual_roughness);
    for (int k = 0; k < 2; ++k) specular[k] = mix(specular[k], (1.0 - met.a) * open[k] + met.rgb, traced);
#endif
#if TRACED_REFRACTION
    vec4 mirrored = traced_light(u_mirrored, n_geometric);
    float share = mirrored.a >= 0.0 ? 1.0 - smoothstep(0.2, 0.5, s.perceptual_roughness) : 0.0; // of a lobe one ray is
    for (int k = 0; k < 2; ++k) specular[k] = mix(specular[k], mirrored.rgb, share);
#endif
    vec3 radiance = vec3(0.0);
#if METALNESS != 1
    radiance += (METALNESS == 2 ? 1.0 - s.metallic : 1.0)
              * environment_response(s.dielectric, split_sum, specular, s.base_color, mean_light);
#endif
#if METALNESS != 0
    radiance += (METALNESS == 2 ? s.metallic : 1.0)
              * environment_response(s.metal, split_sum, specular, vec3(0.0), mean_light);
#endif
    return radiance;
}
