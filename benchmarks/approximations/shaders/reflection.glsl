// The environment's reflection by other ways than the renderer's: the alternatives that `benchmarks.approximations`
// measures.
#include "bsdf/constants.glsl"
#include "light/dfg.glsl"
#include "light/irradiance.glsl"
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

// The split sum, seen from v over the normal n, f90 = 1. As the renderer does it, by one or two lookups and the
// irradiance at the normal, each with weights of its own in the two parts:
vec3 reflected_by_lookups(sampler2D map, sampler2D dfg, sampler2D irradiance, vec3 n, vec3 v,
                          float perceptual_roughness, float f0, int count) {
    vec2 ab = dfg_albedo(dfg, dot(n, v), perceptual_roughness) * vec2(f0, 1.0), rest = vec2(1.0);
    vec3 r = reflect(-v, n), sum = vec3(0.0);
    for (int k = 0; k < count; ++k) {
        vec4 lookup = lobe_lookup(dfg, dot(n, v), perceptual_roughness, count + k);
        vec3 d = normalize(mix(n, r, lookup.x));
        sum += dot(ab, lookup.zw) * (lookup.y > WIDEST_PREFILTERED
            ? wide_radiance(irradiance, d, lookup.y - WIDEST_PREFILTERED) : prefiltered_radiance(map, d, lookup.y));
        rest -= lookup.zw;
    }
    return sum + dot(ab, rest) * irradiance_over_pi(irradiance, n);
}

// Each part along its own mean direction, from the level as wide as it is; `means` has t and the level of both parts:
vec3 reflected_by_parts(sampler2D map, sampler2D dfg, sampler2D means, vec3 n, vec3 v, float perceptual_roughness,
                        float f0) {
    vec2 ab = dfg_albedo(dfg, dot(n, v), perceptual_roughness) * vec2(f0, 1.0);
    vec4 mean = textureLod(means, dfg_uv(dot(n, v), perceptual_roughness) * vec2(1.0, 4.0), 0.0);
    vec3 r = reflect(-v, n);
    return ab.x * prefiltered_radiance(map, normalize(mix(n, r, mean.x)), mean.z)
        + ab.y * prefiltered_radiance(map, normalize(mix(n, r, mean.y)), mean.w);
}

// Both along the mean of the two directions, by what each part weighs:
vec3 reflected_by_whole(sampler2D map, sampler2D dfg, sampler2D means, vec3 n, vec3 v, float perceptual_roughness,
                        float f0) {
    vec2 ab = dfg_albedo(dfg, dot(n, v), perceptual_roughness) * vec2(f0, 1.0);
    vec4 mean = textureLod(means, dfg_uv(dot(n, v), perceptual_roughness) * vec2(1.0, 4.0), 0.0);
    vec2 both = mix(mean.xz, mean.yw, ab.y / max(ab.x + ab.y, 1e-4));
    return (ab.x + ab.y) * prefiltered_radiance(map, normalize(mix(n, reflect(-v, n), both.x)), both.y);
}

// Along the mirror direction                   Karis 2013, "Real Shading in Unreal Engine 4"
vec3 reflected_by_mirror(sampler2D map, sampler2D dfg, vec3 n, vec3 v, float perceptual_roughness, float f0) {
    vec2 ab = dfg_albedo(dfg, dot(n, v), perceptual_roughness);
    return (f0 * ab.x + ab.y) * prefiltered_radiance(map, reflect(-v, n), lod_of_roughness(perceptual_roughness));
}

// Along a fit of the lobe's peak               Lagarde & de Rousiers 2014, "Moving Frostbite to PBR", listing 22
vec3 reflected_by_peak(sampler2D map, sampler2D dfg, vec3 n, vec3 v, float perceptual_roughness, float f0) {
    vec2 ab = dfg_albedo(dfg, dot(n, v), perceptual_roughness);
    float alpha = perceptual_roughness * perceptual_roughness;
    vec3 d = normalize(mix(n, reflect(-v, n), (1.0 - alpha) * (sqrt(1.0 - alpha) + alpha)));
    return (f0 * ab.x + ab.y) * prefiltered_radiance(map, d, lod_of_roughness(perceptual_roughness));
}
