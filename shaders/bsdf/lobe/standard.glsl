// The raster's material as a lobe: standard.glsl with the factors D and V of microfacet.glsl.
// The base gets what the facet between wo and wi lets through, so that base and interface together may reflect more
// than all at grazing; neither that nor Turquin's factor is reciprocal in sum.
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
    vec3 f90;
    float alpha;
};

struct StandardInterfaces {
    Interface dielectric, metal;
};

StandardInterfaces standard_interfaces(Standard m, float NoV, sampler2D dfg) {
    vec2 ab = dfg_albedo(dfg, NoV, m.alpha < DELTA_ALPHA ? 0.0 : sqrt(m.alpha));
    return StandardInterfaces(make_interface(m.f0, m.f90, ab), make_interface(m.base_color, vec3(1.0), ab));
}

vec3 standard_eval(Standard m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return vec3(0.0);
    StandardInterfaces faces = standard_interfaces(m, wo.z, dfg);
    vec3 h = normalize(wo + wi);
    float VoH = clamp(dot(wo, h), 0.0, 1.0);
    float dv = 0.0;
    if (m.alpha >= DELTA_ALPHA) {
        dv = d_microfacet(h.z, dot(h.xy, h.xy), m.alpha) * v_microfacet(wo.z, wi.z, h.z, VoH, m.alpha);
    }
    vec3 F = f_schlick(m.f0, m.f90, VoH);
    return mix(dielectric_response(faces.dielectric, m.base_color, F, dv),
               metal_response(faces.metal, VoH, dv), m.metallic);
}

// Of the facets against facets and base, by what each reflects
float standard_specular_probability(Standard m, float NoV, sampler2D dfg) {
    StandardInterfaces faces = standard_interfaces(m, NoV, dfg);
    float facets = luminance(mix(faces.dielectric.E_ss * shown_reflection(faces.dielectric),
                                 faces.metal.E_ss * shown_reflection(faces.metal), m.metallic));
    float base = (1.0 - m.metallic) * (1.0 - max3(faces.dielectric.E_ss)) * luminance(m.base_color);
    return base > 0.0 ? facets / (facets + base) : 1.0;
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
        vec3 F = mix(f_schlick(m.f0, m.f90, wo.z), f_schlick(m.base_color, vec3(1.0), wo.z), m.metallic);
        return BsdfSample(vec3(-wo.xy, wo.z), F / p_specular, p_specular, REFLECTION | DELTA, 1.0);
    } else {
        vec3 h = sample_half(wo, m.alpha, u.xy);
        wi = normalize(2.0 * dot(wo, h) * h - wo);
    }
    if (wi.z <= 0.0) return NO_SAMPLE;
    float pdf = standard_pdf(m, wo, wi, dfg);
    return BsdfSample(wi, standard_eval(m, wo, wi, dfg) * (wi.z / max(pdf, 1e-30)), pdf, REFLECTION, 1.0);
}

// The base's share under a uniform light: F is linear in x = (1 - VoH)^5, whose mean over a diffuse base is the
// polynomial here, to 1e-5.
vec3 standard_albedo(Standard m, float NoV, sampler2D dfg) {
    StandardInterfaces faces = standard_interfaces(m, NoV, dfg);
    float c = NoV;
    float x = 0.02816537 + c * (-0.07986442 + c * (0.08649544 + c * (-0.04371615 + c * 0.00900256)));
    vec3 base = m.base_color * (1.0 - max3(mix(m.f0, m.f90, x)));
    return mix(faces.dielectric.E_ss * shown_reflection(faces.dielectric) + base,
               faces.metal.E_ss * shown_reflection(faces.metal), m.metallic);
}
