// The surface of a point as the eye sees it: the albedos of its layers towards the eye, which all lights share.
#include "raster/lobe_width.glsl"
#if HAS_TRANSMISSION && REFLECTS && METALNESS != 1
#include "raster/glass_reflectance.glsl"
#endif

// Also widens and stretches the lobe of the surface.
SurfaceView seen_surface(MaterialInputs m, inout Surface s, inout Point p) {
    widen_lobe(s, p);
#if SPECULAR_AA || ANISOTROPIC || NORMAL_MAP
    float perceptual_roughness = table_roughness(s);
#else
    float perceptual_roughness = m.perceptual_roughness;
#endif
    vec4 dfg = vec4(0.0); // (a, b) of the split sum, and their means over all directions
#if REFLECTS && ANISOTROPIC
    vec2 seen = facet_albedo(s, p.v * p.frame, perceptual_roughness, u_dfg);
    dfg = vec4(seen, facet_mean(s, perceptual_roughness, u_dfg));
#elif REFLECTS
    dfg = dfg_albedo_and_mean(u_dfg, p.NoV, perceptual_roughness);
#endif
#if HAS_TRANSMISSION && REFLECTS && METALNESS != 1
    reflect_as_glass(s, m.transmission, dfg.xy);
#endif
    SurfaceView view = view_surface(s, p.NoV, perceptual_roughness, dfg.xy, dfg.zw);
#if SHEEN
    view.sheen = sheen_of(s, view, u_dfg);
#endif
#if GROOVED
    stretch_over_grooves(s, view, p, dfg.xy);
#endif
#if CLEARCOAT
    vec3 n_coat = coat_normal(p.n_geometric);
#if CLEARCOAT_NORMAL_MAP && HAS_TANGENT
    n_coat = bent_over_triangle(n_coat, p.n_geometric, p.v);
#endif
    view.coat = make_coat(s.coat, coat_alpha(s, n_coat, p), n_coat, clamp(dot(n_coat, p.v), 1e-4, 1.0), u_dfg);
#endif
    return view;
}

#if LIGHT_COUNT > 0
// The highlight of a light has a least width, which the environment's reflection does not need: its maps are as sharp
// as they are.
void widen_for_lights(inout Surface s, inout SurfaceView view, inout Point p) {
    const float least = MIN_PERCEPTUAL_ROUGHNESS * MIN_PERCEPTUAL_ROUGHNESS;
    s.alpha = max(s.alpha, least);
    s.alpha_t = max(s.alpha_t, least);
    p.alphas = max(p.alphas, least);
    p.facet_alpha = max(p.facet_alpha, least);
#if CLEARCOAT
    view.coat.alpha = max(view.coat.alpha, least);
    p.coat_alpha = max(p.coat_alpha, least);
    p.coat_facet_alpha = max(p.coat_facet_alpha, least);
#endif
}
#endif
