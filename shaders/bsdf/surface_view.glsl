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
    return v;
}

#if SHEEN
Sheen sheen_of(Surface s, SurfaceView v, sampler2D dfg) {
    Sheen sheen = make_sheen(s.sheen_color, s.sheen_roughness, v.NoV);
#if METALNESS != 1
    sheen.mean = sheen_mean(sheen, v.dielectric, v.perceptual_roughness, dfg);
#endif
    return sheen;
}
#endif
