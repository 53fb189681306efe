// The directional albedo of GGX, f0 a + f90 b, by other ways than the renderer's table: the alternatives that
// `benchmarks.approximations` measures.

// A table of any size, laid out as the upper half of the renderer's (viewer/bake/dfg.py).
vec2 dfg_albedo_of_size(sampler2D table, float NoV, float perceptual_roughness, float size) {
    vec2 uv = vec2(perceptual_roughness, sqrt(NoV)) * ((size - 1.0) / size) + 0.5 / size;
    return textureLod(table, uv, 0.0).rg;
}

// Karis 2014, "Physically Based Shading on Mobile"; to masking with k = alpha / 2
vec2 dfg_karis(float NoV, float perceptual_roughness) {
    vec4 r = perceptual_roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a004 = min(r.x * r.x, exp2(-9.28 * NoV)) * r.x + r.y;
    return vec2(-1.04, 1.04) * a004 + r.zw;
}

// Gloss as the next two have it, alpha = (1 - 0.7 gloss)^6
float gloss(float perceptual_roughness) {
    return clamp((1.0 - pow(perceptual_roughness, 1.0 / 3.0)) / 0.7, 0.0, 1.0);
}

// Lazarov 2013, "Getting More Physical in Call of Duty: Black Ops II", fitted to GGX by Narkowicz 2014, "Analytical DFG
// Term for IBL"
vec2 dfg_lazarov(float NoV, float perceptual_roughness) {
    vec4 t = gloss(perceptual_roughness) * vec4(0.5745, 1.548, -0.02397, 1.301)
           + vec4(0.5753, -0.2511, -0.02066, 0.4755);
    float b = clamp(t.x * min(t.y, exp2(-7.672 * NoV)) + t.z, 0.0, 1.0);
    return vec2(clamp(t.w, 0.0, 1.0) - b, b);
}

// Narkowicz 2014, the polynomial
vec2 dfg_narkowicz(float NoV, float perceptual_roughness) {
    float x = gloss(perceptual_roughness), y = NoV;
    float b = min(x * (-0.1688 + x * 1.895), 0.9903 + y * (-4.853 + y * (8.404 - y * 5.069)));
    b = clamp(b, 0.0, 1.0);
    float sum = 0.6045 + x * (1.699 + x * (-3.603 + x * 2.661) + y * 1.404) + y * (-0.5228 + y * 0.1939);
    return vec2(clamp(sum, 0.0, 1.0) - b, b);
}

// Quotient of two polynomials of degree 2 in each of NoV and alpha, as MaterialX 1.38 has it (Stone 2021)
vec2 dfg_materialx(float NoV, float alpha) {
    float x = NoV, y = alpha;
    vec4 r = vec4(0.1003, 0.9345, 1.0, 1.0)
           + x * (vec4(-0.6303, -2.323, -1.765, 0.2281) + x * vec4(29.34, 1.424, 28.96, 13.08))
           + y * (vec4(9.748, 2.229, 8.263, 15.94) + y * vec4(-8.245, -0.7684, -7.507, 41.26))
           + x * y * (vec4(-2.038, -3.748, 11.53, -55.83) + x * vec4(-26.44, 1.436, -36.11, 54.9)
                      + y * (vec4(19.99, 0.2913, 15.86, 300.2) + x * vec4(-5.448, 0.6286, 33.37, -285.1)));
    return clamp(r.xy / r.zw, 0.0, 1.0);
}
