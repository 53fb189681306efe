// The environment's reflection by other ways than the renderer's: the alternatives that `benchmarks.approximations`
// measures.
#include "bsdf/constants.glsl"
#include "light/dfg.glsl"
#include "light/prefiltered.glsl"
#include "sample/lattice.glsl"

// The lobe about d seen along d, by `count` of its directions, each from the level of the plain map whose texels are as
// wide as what it stands for. That they are narrower towards the poles is left out of account: so the error is less.
// Krivanek & Colbert 2008, "Real-time Shading with Filtered Importance Sampling"
vec3 sampled_reflection(sampler2D map, vec3 d, float perceptual_roughness, int count) {
    float a2 = pow(perceptual_roughness, 4.0);
    vec3 up = abs(d.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0);
    vec3 tangent = normalize(cross(up, d)), across = cross(d, tangent);
    float texel = PI / float(textureSize(map, 0).y);
    vec3 sum = vec3(0.0);
    float weight = 0.0;
    for (int i = 0; i < count; ++i) {
        vec2 u = hammersley(uint(i), uint(count));
        float NoH2 = (1.0 - u.x) / (1.0 + (a2 - 1.0) * u.x); // Walter et al. 2007, eq. 35
        float NoH = sqrt(NoH2), sine = sqrt(max(1.0 - NoH2, 0.0)), phi = 2.0 * PI * u.y;
        vec3 h = sine * cos(phi) * tangent + sine * sin(phi) * across + NoH * d;
        vec3 l = 2.0 * NoH * h - d;
        float NoL = 2.0 * NoH2 - 1.0;
        float q = NoH2 * (a2 - 1.0) + 1.0;
        float pdf = a2 * INV_PI / (4.0 * q * q); // D NoH / (4 VoH)
        float lod = max(0.5 * log2(1.0 / (float(count) * pdf * texel * texel)), 0.0);
        if (NoL > 0.0) {
            sum += NoL * textureLod(map, equirect_uv(l), lod).rgb;
            weight += NoL;
        }
    }
    return sum / weight;
}

// The split sum, seen from v over the normal n, f90 = 1. Each part along its own mean direction:
vec3 reflected_by_parts(sampler2D map, sampler2D dfg, vec3 n, vec3 v, float perceptual_roughness, float f0) {
    SplitSum s = dfg_lookup(dfg, dot(n, v), perceptual_roughness);
    vec3 r = reflect(-v, n);
    vec3 a = prefiltered_radiance(map, normalize(mix(n, r, s.t.x)), s.roughness.x);
    vec3 b = prefiltered_radiance(map, normalize(mix(n, r, s.t.y)), s.roughness.y);
    return f0 * s.albedo.x * a + s.albedo.y * b;
}

// Both along the first's:
vec3 reflected_by_first_part(sampler2D map, sampler2D dfg, vec3 n, vec3 v, float perceptual_roughness, float f0) {
    SplitSum s = dfg_lookup(dfg, dot(n, v), perceptual_roughness);
    vec3 d = normalize(mix(n, reflect(-v, n), s.t.x));
    return (f0 * s.albedo.x + s.albedo.y) * prefiltered_radiance(map, d, s.roughness.x);
}

// Both along the mean of the two directions, by what each part weighs, as the renderer does for metals:
vec3 reflected_by_whole(sampler2D map, sampler2D dfg, vec3 n, vec3 v, float perceptual_roughness, float f0) {
    SplitSum s = dfg_lookup(dfg, dot(n, v), perceptual_roughness);
    vec2 both = common_lookup(s, f0);
    vec3 d = normalize(mix(n, reflect(-v, n), both.x));
    return (f0 * s.albedo.x + s.albedo.y) * prefiltered_radiance(map, d, both.y);
}

// Along the mirror direction                   Karis 2013, "Real Shading in Unreal Engine 4"
vec3 reflected_by_mirror(sampler2D map, sampler2D dfg, vec3 n, vec3 v, float perceptual_roughness, float f0) {
    vec2 ab = dfg_albedo(dfg, dot(n, v), perceptual_roughness);
    return (f0 * ab.x + ab.y) * prefiltered_radiance(map, reflect(-v, n), perceptual_roughness);
}

// Along a fit of the lobe's peak               Lagarde & de Rousiers 2014, "Moving Frostbite to PBR", listing 22
vec3 reflected_by_peak(sampler2D map, sampler2D dfg, vec3 n, vec3 v, float perceptual_roughness, float f0) {
    vec2 ab = dfg_albedo(dfg, dot(n, v), perceptual_roughness);
    float alpha = perceptual_roughness * perceptual_roughness;
    vec3 d = normalize(mix(n, reflect(-v, n), (1.0 - alpha) * (sqrt(1.0 - alpha) + alpha)));
    return (f0 * ab.x + ab.y) * prefiltered_radiance(map, d, perceptual_roughness);
}
