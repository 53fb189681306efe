// The DFG table of the split sum (Karis 2013), made by viewer/bake/dfg.py. The directional albedo is f0 * a + f90 * b.
// For each of the two parts the table also has the direction and roughness to look up the prefiltered environment with;
// the direction is mix(n, r, t). It also has the hemispherical means of a and b, 2 int a mu dmu.
#define DFG_SIZE 64.0

struct SplitSum {
    vec2 albedo;    // a, b
    vec2 t;         // for a and b; see above
    vec2 roughness; // perceptual roughness for a and b
};

// u = perceptual roughness, v = sqrt(NoV), between the centres of the first and last texel, in the upper half of the
// table.
vec2 dfg_uv(float NoV, float perceptual_roughness) {
    vec2 uv = vec2(perceptual_roughness, sqrt(max(NoV, 0.0))) * ((DFG_SIZE - 1.0) / DFG_SIZE) + 0.5 / DFG_SIZE;
    return uv * vec2(1.0, 0.5);
}

vec2 dfg_albedo(sampler2D table, float NoV, float perceptual_roughness) {
    return textureLod(table, dfg_uv(NoV, perceptual_roughness), 0.0).rg;
}

vec2 dfg_mean(sampler2D table, float perceptual_roughness) {
    return textureLod(table, dfg_uv(1.0, perceptual_roughness) + vec2(0.0, 0.5), 0.0).ba;
}

SplitSum dfg_lookup(sampler2D table, float NoV, float perceptual_roughness) {
    vec2 uv = dfg_uv(NoV, perceptual_roughness);
    vec4 upper = textureLod(table, uv, 0.0);
    return SplitSum(upper.rg, upper.ba, textureLod(table, uv + vec2(0.0, 0.5), 0.0).rg);
}

// t and roughness for one common lookup of both parts: the means weighted by the parts' albedos.
vec2 common_lookup(SplitSum s, float f0) {
    float second = s.albedo.y / max(f0 * s.albedo.x + s.albedo.y, 1e-4);
    return mix(vec2(s.t.x, s.roughness.x), vec2(s.t.y, s.roughness.y), second);
}
