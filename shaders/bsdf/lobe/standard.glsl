// The raster's material as a lobe: standard.glsl with the factors D and V of microfacet.glsl.
#include "bsdf/bsdf.glsl"
#include "bsdf/half_vector.glsl"
#include "bsdf/standard.glsl"
#include "light/dfg.glsl"
#include "sample/hemisphere.glsl"
#include "sample/luminance.glsl"

struct Standard {
    vec3 base_color;
    float metallic;
    vec3 f0;  // of the dielectric
    float f90;
    float alpha;
    float ior; // f0 without weight and tint, for FRESNEL = 1
};

// What is the same for every wi: worked out once where several are asked for.
struct StandardView {
    Interface dielectric, metal;
    vec3 single, diffuse;  // albedo of what the facets send on at once, and of what comes out diffuse
    float perceptual_roughness;
    float p_specular;      // with which a sample is one of the facets
};

float standard_perceptual_roughness(Standard m) {
    return m.alpha < DELTA_ALPHA ? 0.0 : sqrt(m.alpha);
}

StandardView standard_view(Standard m, float NoV, sampler2D dfg) {
    StandardView v;
    v.perceptual_roughness = standard_perceptual_roughness(m);
    vec2 ab = dfg_albedo(dfg, NoV, v.perceptual_roughness), mean = dfg_mean(dfg, v.perceptual_roughness);
    v.dielectric = make_interface(m.f0, vec3(m.f90), ab, mean);
    v.metal = make_interface(m.base_color, vec3(1.0), ab, mean);
    v.single = mix(v.dielectric.E_ss, v.metal.E_ss, m.metallic) * float(SHOW_SPECULAR);
    // After several facets, or from the base, whose albedo is (1 - s(o)) rho
    vec3 multiple = mix(v.dielectric.F_ms, v.metal.F_ms, m.metallic) * lost(ab);
    vec3 base = (1.0 - m.metallic) * transmitted(v.dielectric, ab) * m.base_color;
    v.diffuse = multiple * float(SHOW_MULTISCATTER) + base * float(SHOW_DIFFUSE);
    float single = luminance(v.single), diffuse = luminance(v.diffuse);
    v.p_specular = diffuse > 0.0 ? single / (single + diffuse) : 1.0;
    return v;
}

// f, and in w the pdf
vec4 standard_eval_pdf(Standard m, StandardView v, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return vec4(0.0);
    vec2 ab = dfg_albedo(dfg, wi.z, v.perceptual_roughness);
    vec3 h = normalize(wo + wi);
    float VoH = clamp(dot(wo, h), 0.0, 1.0);
    float dv = 0.0, facets = 0.0;
    if (m.alpha >= DELTA_ALPHA) {
        dv = d_microfacet(h.z, dot(h.xy, h.xy), m.alpha) * v_microfacet(wo.z, wi.z, h.z, VoH, m.alpha);
        facets = pdf_half_reflection(wo, h, m.alpha);
    }
    vec3 dielectric = interface_response(v.dielectric, dielectric_fresnel(v.dielectric, VoH, m.ior), dv, ab)
                    + base_response(v.dielectric, m.base_color, ab);
    vec3 metal = interface_response(v.metal, f_schlick(m.base_color, vec3(1.0), VoH), dv, ab);
    return vec4(mix(dielectric, metal, m.metallic), mix(pdf_cosine_hemisphere(wi), facets, v.p_specular));
}

BsdfSample standard_sample_view(Standard m, StandardView v, vec3 wo, vec3 u, sampler2D dfg) {
    if (wo.z <= 0.0) return NO_SAMPLE;
    vec3 wi;
    if (u.z >= v.p_specular) {
        wi = sample_cosine_hemisphere(u.xy);
    } else if (m.alpha < DELTA_ALPHA) {
        vec3 F = mix(dielectric_fresnel(v.dielectric, wo.z, m.ior), f_schlick(m.base_color, vec3(1.0), wo.z), m.metallic);
        F *= float(SHOW_SPECULAR);
        return BsdfSample(vec3(-wo.xy, wo.z), F / v.p_specular, v.p_specular, REFLECTION | DELTA, 1.0);
    } else {
        vec3 h = sample_half(wo, m.alpha, u.xy);
        wi = normalize(2.0 * dot(wo, h) * h - wo);
    }
    if (wi.z <= 0.0) return NO_SAMPLE;
    vec4 f = standard_eval_pdf(m, v, wo, wi, dfg);
    return BsdfSample(wi, f.rgb * (wi.z / max(f.w, 1e-30)), f.w, REFLECTION, 1.0);
}

vec3 standard_eval(Standard m, vec3 wo, vec3 wi, sampler2D dfg) {
    return standard_eval_pdf(m, standard_view(m, wo.z, dfg), wo, wi, dfg).rgb;
}

float standard_pdf(Standard m, vec3 wo, vec3 wi, sampler2D dfg) {
    return standard_eval_pdf(m, standard_view(m, wo.z, dfg), wo, wi, dfg).w;
}

BsdfSample standard_sample(Standard m, vec3 wo, vec3 u, sampler2D dfg) {
    return standard_sample_view(m, standard_view(m, wo.z, dfg), wo, u, dfg);
}

vec3 standard_albedo(Standard m, float NoV, sampler2D dfg) {
    StandardView v = standard_view(m, NoV, dfg);
    return v.single + v.diffuse;
}
