// Multiple scattering between GGX facets, as a second, diffuse part of the lobe.
//   f_ms = (1 - E(o)) (1 - E(i)) / (pi (1 - E_mean)) * F_mean^2 E_mean / (1 - F_mean (1 - E_mean))
// Kulla & Conty 2017, "Revisiting Physically Based Shading at Imageworks". E is the directional albedo of the lobe with
// F = 1, from the DFG table, and E_mean its mean 2 int E mu dmu. The lobe is reciprocal, and its albedo is 1 for F = 1.
#include "bsdf/ggx_reflection.glsl"
#include "bsdf/multiscatter.glsl"
#include "sample/hemisphere.glsl"
#include "sample/luminance.glsl"
#include "sample/share_of.glsl"

float ggx_white_albedo(sampler2D dfg, float NoV, float perceptual_roughness) {
    vec2 ab = dfg_albedo(dfg, NoV, perceptual_roughness);
    return min(ab.x + ab.y, 1.0);
}

// 1 - E_mean. It comes from the same table as E, so that both have the same interpolation errors.
float ggx_mean_loss(sampler2D dfg, float perceptual_roughness) {
    vec2 mean = dfg_mean(dfg, perceptual_roughness);
    return 1.0 - mean.x - mean.y;
}

vec3 kulla_conty_eval(vec2 alpha, vec3 F_mean, vec3 wo, vec3 wi, sampler2D dfg) {
    float r = mean_perceptual_roughness(alpha);
    float loss = ggx_mean_loss(dfg, r);
    if (wo.z <= 0.0 || wi.z <= 0.0 || loss < 1e-4) return vec3(0.0); // a loss below 1e-4 is an error of the table
    float lost = (1.0 - ggx_white_albedo(dfg, wo.z, r)) * (1.0 - ggx_white_albedo(dfg, wi.z, r));
    return kulla_conty_fresnel(F_mean, loss) * (lost * INV_PI / loss);
}

vec3 kulla_conty_albedo(vec2 alpha, vec3 F_mean, float NoV, sampler2D dfg) {
    float r = mean_perceptual_roughness(alpha);
    float loss = ggx_mean_loss(dfg, r);
    return loss < 1e-4 ? vec3(0.0) : kulla_conty_fresnel(F_mean, loss) * (1.0 - ggx_white_albedo(dfg, NoV, r));
}

// The probability of sampling the diffuse part, in proportion to the albedos
float kulla_conty_probability(vec2 alpha, vec3 F_mean, vec3 wo, sampler2D dfg) {
    float diffuse = luminance(kulla_conty_albedo(alpha, F_mean, wo.z, dfg));
    float facets = luminance(F_mean) * ggx_white_albedo(dfg, wo.z, mean_perceptual_roughness(alpha));
    return share_of(diffuse, facets);
}

// The density of compensated_direction: facets and diffuse part together
float compensated_pdf(vec2 alpha, float p_diffuse, vec3 wo, vec3 wi) {
    float diffuse = wo.z > 0.0 ? pdf_cosine_hemisphere(wi) : 0.0;
    return mix(ggx_reflection_pdf(alpha, wo, wi), diffuse, p_diffuse);
}

// Samples a direction and its pdf. The weight is 0 (or that of a mirror for F = 1): compensated_weight computes it,
// since it depends on F.
BsdfSample compensated_direction(vec2 alpha, float p_diffuse, vec3 wo, vec3 u, out float VoH) {
    BsdfSample s;
    if (u.z < p_diffuse) {
        s = BsdfSample(sample_cosine_hemisphere(u.xy), vec3(0.0), 0.0, REFLECTION, 1.0);
        VoH = dot(wo, normalize(wo + s.wi));
        if (wo.z <= 0.0 || s.wi.z <= 0.0) return NO_SAMPLE;
    } else {
        s = ggx_reflection_sample(alpha, wo, u.xy, VoH);
        if ((s.flags & DELTA) != 0u || s.flags == 0u) return s;
    }
    s.pdf = compensated_pdf(alpha, p_diffuse, wo, s.wi);
    return s;
}

// The weight of the sample s: from f, or, for a mirror, F
vec3 compensated_weight(BsdfSample s, vec3 f, vec3 F) {
    if ((s.flags & DELTA) != 0u) return F;
    return s.pdf > 0.0 ? f * (s.wi.z / s.pdf) : vec3(0.0);
}
