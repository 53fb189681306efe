// The split sum's table (Karis 2013), made by viewer/bake/dfg.py: directional albedo = f0 * a + f90 * b, and for each of
// the two parts where the filtered environment is to be looked up: along mix(n, r, t), with which roughness. And the
// means of a and b over the hemisphere, 2 int a mu dmu.
#define DFG_SIZE 64.0

struct SplitSum {
    vec2 albedo;    // a, b
    vec2 t;         // share of the mirror direction, of a and of b
    vec2 roughness; // perceptual
};

// u = perceptual roughness, v = sqrt(NoV), from the first texel's centre to the last one's, in either half of the table.
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

// Where to look up both parts at once, by what each weighs: t and the roughness.
vec2 common_look_up(SplitSum s, float f0) {
    float second = s.albedo.y / max(f0 * s.albedo.x + s.albedo.y, 1e-4);
    return mix(vec2(s.t.x, s.roughness.x), vec2(s.t.y, s.roughness.y), second);
}
