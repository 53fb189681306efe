// The DFG table of the split sum (Karis 2013), made by viewer/bake/dfg.py. The directional albedo is f0 * a + f90 * b.
// The first quarter of the table has a, b, and their hemispherical means, 2 int a mu dmu and 2 int b mu dmu. The others
// say where to look up the prefiltered environment.
#define DFG_SIZE 64.0

// u = perceptual roughness, v = sqrt(NoV), between the centres of the first and last texel of a quarter.
vec2 dfg_uv(float NoV, float perceptual_roughness) {
    vec2 uv = vec2(perceptual_roughness, sqrt(max(NoV, 0.0))) * ((DFG_SIZE - 1.0) / DFG_SIZE) + 0.5 / DFG_SIZE;
    return uv * vec2(1.0, 0.25);
}

// a, b and their means, which are the same for every NoV
vec4 dfg_albedo_and_mean(sampler2D table, float NoV, float perceptual_roughness) {
    return textureLod(table, dfg_uv(NoV, perceptual_roughness), 0.0);
}

vec2 dfg_albedo(sampler2D table, float NoV, float perceptual_roughness) {
    return dfg_albedo_and_mean(table, NoV, perceptual_roughness).rg;
}

vec2 dfg_mean(sampler2D table, float perceptual_roughness) {
    return dfg_albedo_and_mean(table, 1.0, perceptual_roughness).ba;
}

// One of the lookups that stand for a lobe: t, level, and the weights in the parts a and b. Its direction is
// mix(n, r, t). Lookup 1 is best alone, 2 and 3 are best together.
vec4 lobe_lookup(sampler2D table, float NoV, float perceptual_roughness, int k) {
    return textureLod(table, dfg_uv(NoV, perceptual_roughness) + vec2(0.0, 0.25 * float(k)), 0.0);
}
