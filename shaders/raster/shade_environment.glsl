// Radiance that a surface of pbr.frag reflects from the environment, from other surfaces and from media around it, by
// the split sum: albedos times light. The light of each part of the lobe, a and b, is the weighted sum of a few lookups
// (viewer/bake/lookups.py).

#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif
#if VISIBILITY
#include "raster/visibility.glsl"
#endif
#if TRACED_REFLECTION
#include "raster/traced_reflection.glsl"
#endif
#if TRACED_REFRACTION
#include "raster/traced_refraction.glsl"
#endif
#include "raster/arriving_light.glsl"
#if SCATTERS_INSIDE
#include "raster/light_all_around.glsl"
#endif

#if HAS_ENVIRONMENT && REFLECTS
// mix(h, mirror direction, t) for a facet with the normal h
vec3 reflected_direction(Point p, vec3 h, float t) {
    vec3 d = mix(h, reflect(-p.v, h), t);
    // With a normal map the reflected direction may be below the surface; it is mirrored to the upper side.
    d -= 2.0 * min(dot(d, p.n_geometric), 0.0) * p.n_geometric;
    return normalize(d);
}

// The light of both parts of a lobe about n. `around` is irradiance / pi at n, `count` the number of lookups: 1 or 2.
mat2x3 reflected_light(Point p, vec3 n, float NoV, float perceptual_roughness, int count, vec3 around) {
    mat2x3 light = mat2x3(0.0);
    vec2 rest = vec2(1.0);
    for (int k = 0; k < count; ++k) {
        vec4 lookup = lobe_lookup(u_dfg, NoV, perceptual_roughness, count + k);
        vec3 d = reflected_direction(p, n, lookup.x);
        // Of two lookups the first is the wider one.
        vec3 seen = k + 1 < count ? environment_wide_level(d, lookup.y) : environment_level(d, lookup.y);
        light += outerProduct(seen, lookup.zw);
        rest -= lookup.zw;
    }
    return light + outerProduct(around, max(rest, 0.0));
}

#if ANISOTROPIC
#include "raster/stretched_light.glsl"
#endif
#endif

#if CLEARCOAT
// The coat looks along its own lobe. Rays are traced for what lies below it only.
vec3 shade_coat(Point p, Coat c, float occlusion, vec4 visible) {
    mat2x3 light = mat2x3(0.0);
    vec3 around = vec3(0.0);
#if HAS_ENVIRONMENT
    around = environment_irradiance_over_pi(c.n);
    light = reflected_light(p, c.n, c.NoV, c.perceptual_roughness, COAT_LOOKUPS, around);
#endif
#if MEDIA
    light_through_media(c.n, reflect(-p.v, c.n), light, around);
#endif
    meet_other_surfaces(c.NoV, c.alpha, occlusion, visible, light, around);
    return coat_environment(c, light, around);
}
#endif

#if SHEEN
// The sheen gathers light about an axis of its own. What hides light of the base is taken to hide the same part of it.
vec3 shade_sheen(Point p, Sheen s, float occlusion, vec4 visible) {
    mat2x3 specular = mat2x3(0.0);
    vec3 around = vec3(0.0), axis = sheen_axis(s, p.n, p.v, p.NoV);
#if HAS_ENVIRONMENT
    around = environment_irradiance_over_pi(axis);
#if ZELTNER
    around = mix(0.5 * (around + environment_irradiance_over_pi(-axis)), around, sheen_sidedness(s));
#endif
#endif
#if MEDIA
    light_through_media(axis, axis, specular, around);
#endif
    meet_other_surfaces(p.NoV, 1.0, occlusion, visible, specular, around);
    return s.albedo * around;
}
#endif

vec3 shade_environment(Point p, Surface s, SurfaceView view, float occlusion, vec4 visible) {
    mat2x3 specular = mat2x3(0.0);
    vec3 mean_light = vec3(0.0);
#if HAS_ENVIRONMENT
    mean_light = environment_irradiance_over_pi(p.n);
#if GROOVED && REFLECTS
    vec2 alpha = both_alphas(s);
    bool is_stretched = alpha.x > 1.2 * alpha.y;
    specular = is_stretched ? stretched_light(p, s, mean_light)
        : reflected_light(p, p.n, p.NoV, view.perceptual_roughness, 2, mean_light);
#elif ANISOTROPIC && REFLECTS
    specular = stretched_light(p, s, mean_light);
#elif REFLECTS
    specular = reflected_light(p, p.n, p.NoV, view.perceptual_roughness, LOOKUPS, mean_light);
#endif
#if DIFFUSE_ROUGH
    mean_light = environment_irradiance_over_pi(diffuse_axis(s, p.n, p.v, p.NoV));
#endif
#endif
#if MEDIA
    light_through_media(p.n, reflect(-p.v, p.n), specular, mean_light);
#endif
#if TRACED_REFLECTION
    mat2x3 unoccluded = specular;
#endif
    meet_other_surfaces(p.NoV, mean_alpha(s), occlusion, visible, specular, mean_light);
#if TRACED_REFLECTION
    // rgb: radiance, a: fraction of rays that hit
    vec4 hit = traced_reflection(v_position, p.n_geometric, shading_normal(p.n_geometric));
    float traced = traced_share(view.perceptual_roughness);
#if GROOVED
    traced *= s.alpha / s.alpha_t; // one ray cannot stand for a stretched lobe
#endif
    for (int k = 0; k < 2; ++k) specular[k] = mix(specular[k], (1.0 - hit.a) * unoccluded[k] + hit.rgb, traced);
#endif
#if TRACED_REFRACTION && !ANISOTROPIC // one ray cannot stand for a stretched lobe
    vec4 mirrored = traced_light(u_mirrored, p.n_geometric);
    // One ray represents a smooth lobe well; with growing roughness it is faded out.
    float weight = mirrored.a >= 0.0 ? 1.0 - smoothstep(0.2, 0.5, view.perceptual_roughness) : 0.0;
    for (int k = 0; k < 2; ++k) specular[k] = mix(specular[k], mirrored.rgb, weight);
#endif
    vec3 radiance = surface_environment(s, view, specular, mean_light);
#if DIFFUSE_TRANSMISSION && HAS_ENVIRONMENT
    vec3 through = environment_irradiance_over_pi(-p.n);
#if SUBSURFACE && INDIRECT
    through = meet_surfaces_behind(through);
#endif
#if IS_SOLID
    through = mix(through, environment_irradiance_over_pi(p.n), p.returned);
#endif
    radiance += surface_transmitted(s, view) * through;
#endif
#if SCATTERS_INSIDE
    radiance += from_all_around(p, s, view) * light_all_around(p, occlusion, visible);
#endif
#if SHEEN
    radiance = sheen_over(view.sheen, shade_sheen(p, view.sheen, occlusion, visible), radiance);
#endif
#if CLEARCOAT
    radiance = coat_over(view.coat, shade_coat(p, view.coat, occlusion, visible), radiance);
#endif
    return radiance;
}
