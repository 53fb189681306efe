// The split sum's table (Karis 2013): directional albedo = f0 * dfg.x + f90 * dfg.y. Made by viewer/bake/dfg.py.
#define DFG_SIZE 64.0

// u = perceptual roughness, v = sqrt(NoV), from the first texel's centre to the last one's.
vec2 dfg_lookup(sampler2D table, float NoV, float perceptual_roughness) {
    vec2 uv = vec2(perceptual_roughness, sqrt(max(NoV, 0.0)));
    return textureLod(table, uv * ((DFG_SIZE - 1.0) / DFG_SIZE) + 0.5 / DFG_SIZE, 0.0).rg;
}
