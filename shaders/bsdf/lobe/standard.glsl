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
};

struct StandardInterfaces {
    Interface dielectric, metal;
};

float standard_perceptual_roughness(Standard m) {
    return m.alpha < DELTA_ALPHA ? 0.0 : sqrt(m.alpha);
}

StandardInterfaces standard_interfaces(Standard m, float NoV, sampler2D dfg) {
    float r = standard_perceptual_roughness(m);
    vec2 ab = dfg_albedo(dfg, NoV, r), mean = dfg_mean(dfg, r);
    return StandardInterfaces(make_interface(m.f0, vec3(m.f90), ab, mean),
                              make_interface(m.base_color, vec3(1.0), ab, mean));
}

vec3 standard_eval(Standard m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return vec3(0.0);
    StandardInterfaces faces = standard_interfaces(m, wo.z, dfg);
    vec2 ab = dfg_albedo(dfg, wi.z, standard_perceptual_roughness(m));
    vec3 h = normalize(wo + wi);
    float VoH = clamp(dot(wo, h), 0.0, 1.0);
    float dv = 0.0;
    if (m.alpha >= DELTA_ALPHA) {
        dv = d_microfacet(h.z, dot(h.xy, h.xy), m.alpha) * v_microfacet(wo.z, wi.z, h.z, VoH, m.alpha);
    }
    vec3 dielectric = interface_response(faces.dielectric, f_schlick(m.f0, vec3(m.f90), VoH), dv, ab)
                    + base_response(faces.dielectric, m.base_color, ab);
    vec3 metal = interface_response(faces.metal, f_schlick(m.base_color, vec3(1.0), VoH), dv, ab);
    return mix(dielectric, metal, m.metallic);
}

// Of what the facets send on at once
vec3 standard_single_albedo(Standard m, StandardInterfaces faces) {
    return mix(faces.dielectric.E_ss, faces.metal.E_ss, m.metallic) * float(SHOW_SPECULAR);
}

// Of what comes out diffuse, after several facets or from the base. The base's is (1 - s(o)) rho.
vec3 standard_diffuse_albedo(Standard m, StandardInterfaces faces, float NoV, sampler2D dfg) {
    vec2 ab = dfg_albedo(dfg, NoV, standard_perceptual_roughness(m));
    vec3 multiple = mix(faces.dielectric.F_ms, faces.metal.F_ms, m.metallic) * lost(ab);
    vec3 base = (1.0 - m.metallic) * transmitted(faces.dielectric, ab) * m.base_color;
    return multiple * float(SHOW_MULTISCATTER) + base * float(SHOW_DIFFUSE);
}

float standard_specular_probability(Standard m, float NoV, sampler2D dfg) {
    StandardInterfaces faces = standard_interfaces(m, NoV, dfg);
    float single = luminance(standard_single_albedo(m, faces));
    float diffuse = luminance(standard_diffuse_albedo(m, faces, NoV, dfg));
    return diffuse > 0.0 ? single / (single + diffuse) : 1.0;
}

float standard_pdf(Standard m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return 0.0;
    float facets = m.alpha < DELTA_ALPHA ? 0.0 : pdf_half_reflection(wo, normalize(wo + wi), m.alpha);
    return mix(pdf_cosine_hemisphere(wi), facets, standard_specular_probability(m, wo.z, dfg));
}

BsdfSample standard_sample(Standard m, vec3 wo, vec3 u, sampler2D dfg) {
    if (wo.z <= 0.0) return NO_SAMPLE;
    float p_specular = standard_specular_probability(m, wo.z, dfg);
    vec3 wi;
    if (u.z >= p_specular) {
        wi = sample_cosine_hemisphere(u.xy);
    } else if (m.alpha < DELTA_ALPHA) {
        vec3 F = mix(f_schlick(m.f0, vec3(m.f90), wo.z), f_schlick(m.base_color, vec3(1.0), wo.z), m.metallic);
        return BsdfSample(vec3(-wo.xy, wo.z), F / p_specular, p_specular, REFLECTION | DELTA, 1.0);
    } else {
        vec3 h = sample_half(wo, m.alpha, u.xy);
        wi = normalize(2.0 * dot(wo, h) * h - wo);
    }
    if (wi.z <= 0.0) return NO_SAMPLE;
    float pdf = standard_pdf(m, wo, wi, dfg);
    return BsdfSample(wi, standard_eval(m, wo, wi, dfg) * (wi.z / max(pdf, 1e-30)), pdf, REFLECTION, 1.0);
}

vec3 standard_albedo(Standard m, float NoV, sampler2D dfg) {
    StandardInterfaces faces = standard_interfaces(m, NoV, dfg);
    return standard_single_albedo(m, faces) + standard_diffuse_albedo(m, faces, NoV, dfg);
}
