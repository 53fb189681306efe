// What surface.glsl, which includes this file, computes once for a direction of view.

// The terms that do not depend on wi
struct SurfaceView {
#if METALNESS != 1
    Interface dielectric;
#endif
#if METALNESS != 0
    Interface metal;
#endif
    float NoV;
    vec2 dfg;                   // (a, b) of the split sum for NoV
    float perceptual_roughness; // for reading the DFG table
#if IRIDESCENT
    Film film;
#endif
#if SHEEN
    Sheen sheen;
#endif
#if CLEARCOAT
    Coat coat;                  // the raster composes it itself, since it has a normal of its own
#endif
};

// This is a macro so that the unused branch is not compiled.
#if METALNESS == 0
#define MIX_METAL(s, dielectric_value, metal_value) (dielectric_value)
#elif METALNESS == 1
#define MIX_METAL(s, dielectric_value, metal_value) (metal_value)
#else
#define MIX_METAL(s, dielectric_value, metal_value) mix(dielectric_value, metal_value, s.metallic)
#endif

#if IRIDESCENT
#include "bsdf/film_albedo.glsl"
#endif

SurfaceView view_surface(Surface s, float NoV, float perceptual_roughness, vec2 dfg, vec2 dfg_mean) {
    SurfaceView v;
    v.NoV = NoV;
    v.dfg = dfg;
    v.perceptual_roughness = perceptual_roughness;
#if METALNESS != 1
    v.dielectric = make_interface(s.f0, vec3(s.f90), dfg, dfg_mean);
#endif
#if METALNESS != 0
    v.metal = make_interface(s.base_color, vec3(1.0), dfg, dfg_mean);
#endif
#if IRIDESCENT
    v.film = Film(s.film, s.film_ior, s.film_thickness, s.film_walls);
    add_film(v, s, dfg_mean);
#endif
    return v;
}

// Fresnel reflectance of the facets, below the film if there is one
#if METALNESS != 1
vec3 dielectric_facets(Surface s, SurfaceView v, float mu) {
    vec3 F = dielectric_fresnel(v.dielectric, mu, s.ior);
#if IRIDESCENT
    F = film_over(v.film, mu, F, film_base_ior(s.f0, s.ior));
#endif
    return F;
}
#endif

#if METALNESS != 0
vec3 metal_facets(SurfaceView v, float mu) {
    vec3 F = metal_fresnel(v.metal, mu);
#if IRIDESCENT
    F = film_over(v.film, mu, F, 0.0);
#endif
    return F;
}
#endif

#if SHEEN
Sheen sheen_of(Surface s, SurfaceView v, sampler2D dfg) {
    Sheen sheen = make_sheen(s.sheen_color, s.sheen_roughness, v.NoV);
#if METALNESS != 1
    vec4 b = vec4(1.0);
#if DIFFUSE_ROUGH
    for (int k = 0; k < 4; ++k) b[k] = diffuse_arriving(s, v.dielectric, v.NoV, SHEEN_NODES[k]);
#endif
    sheen.mean = sheen_mean(sheen, v.dielectric, v.perceptual_roughness, b, dfg);
#endif
    return sheen;
}
#endif
