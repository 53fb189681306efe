// The BSDF of an opaque surface: the only place that composes its layers. Lights, the environment and the path tracer
// all use it.
//   f = coat + throughput of the coat * base
//   base = sheen + throughput of the sheen * ((1 - metallic) (dielectric + throughput of the dielectric * diffuse base)
//          + metallic * metal),   where a thin film may lie on dielectric and metal
// Khronos Group 2021, "glTF 2.0 Specification", appendix B; KHR_materials_specular, _ior, _anisotropy, _clearcoat,
// _sheen, _diffuse_roughness, _diffuse_transmission, _iridescence.
// METALNESS: 0 dielectric, 1 metal, 2 a mixture. Dielectric and metal are evaluated separately and mixed last, because
// multiple scattering is not linear in f0.
#include "bsdf/facets.glsl"
#if CLEARCOAT
#include "bsdf/layer/coat.glsl"
#endif
#if IRIDESCENT
#include "bsdf/film.glsl"
#endif
#include "bsdf/layer/dielectric.glsl"
#include "bsdf/layer/diffuse.glsl"
#include "bsdf/layer/metal.glsl"
#if SHEEN
#include "bsdf/layer/sheen.glsl"
#endif
#include "sample/luminance.glsl"

#include "bsdf/surface_view.glsl"

// f of the base for a light direction. dv = D V of the facets, dfg_light = (a, b) of the split sum for NoL
vec3 surface_response(Surface s, SurfaceView v, Angles a, float dv, vec2 dfg_light) {
    float passed = 1.0;
#if SHEEN
    passed = sheen_throughput(v.sheen, a.NoL) / v.sheen.mean;
#endif
    vec3 f = MIX_METAL(s,
        interface_response(v.dielectric, dielectric_facets(s, v, a.VoH), dv, dfg_light)
            + (passed * interface_throughput(v.dielectric, dfg_light)) * diffuse_response(s, v.dielectric, a),
        interface_response(v.metal, metal_facets(v, a.VoH), dv, dfg_light));
#if SHEEN
    f = sheen_over(v.sheen, sheen_response(v.sheen, a), f);
#endif
    return f;
}

// Radiance that the base reflects from an environment; the arguments are those of interface_environment.
vec3 surface_environment(Surface s, SurfaceView v, mat2x3 specular, vec3 mean_light) {
    return MIX_METAL(s,
        interface_environment(v.dielectric, v.dfg, specular, mean_light)
            + interface_entering(v.dielectric, v.dfg) * (mean_light * diffuse_albedo(s, v.NoV)),
        interface_environment(v.metal, v.dfg, specular, mean_light));
}

// The fraction of light from the viewer's direction that enters the dielectric
TRANSMITTANCE surface_throughput(Surface s, SurfaceView v) {
    return MIX_METAL(s, interface_entering(v.dielectric, v.dfg), TRANSMITTANCE(0.0));
}

// ---- The surface as a lobe, as bsdf/bsdf.glsl defines it, with wo and wi in the local frame. A sample is taken from
// the coat, from the facets or from the diffuse part, with probabilities in proportion to their albedos.

#include "bsdf/surface_albedos.glsl"

// n_coat is the normal of the coat, in the local frame.
SurfaceView surface_view(Surface s, vec3 wo, vec3 n_coat, sampler2D dfg) {
    float roughness = table_roughness(s);
    vec2 seen = facet_albedo(s, wo, roughness, dfg);
    SurfaceView v = view_surface(s, wo.z, roughness, seen, facet_mean(s, roughness, dfg));
#if SHEEN
    v.sheen = sheen_of(s, v, dfg);
#endif
#if CLEARCOAT
    v.coat = make_coat(s.coat, s.coat_alpha, n_coat, dot(n_coat, wo), dfg);
    v.coat.probability = coat_probability(v.coat, luminance(base_albedo(s, v)));
#endif
    return v;
}

// xyz: f |cos|, w: the pdf
vec4 base_eval_pdf(Surface s, SurfaceView v, vec3 wo, vec3 wi, sampler2D dfg) {
#if DIFFUSE_TRANSMISSION
    float p_diffuse = 1.0 - facet_probability(s, v);
#if SHEEN
    p_diffuse *= 1.0 - sheen_probability(s, v);
#endif
    if (wi.z < 0.0) return transmission_eval_pdf(s, v, wo, wi, p_diffuse, dfg);
#endif
    if (wo.z <= 0.0 || wi.z <= 0.0) return vec4(0.0);
    Angles a = local_angles(wo, wi);
    float dv = 0.0, facets = 0.0;
    if (!is_mirror(s)) {
        dv = facet_d(s, a) * facet_v(s, a);
        facets = pdf_facet_reflection(s, wo, normalize(wo + wi));
    }
    vec3 f = surface_response(s, v, a, dv, facet_albedo(s, wi, v.perceptual_roughness, dfg));
    float diffuse = pdf_diffuse(s, wo, wi);
#if DIFFUSE_TRANSMISSION
    diffuse *= 1.0 - below_probability(s, v);
#endif
    float pdf = mix(diffuse, facets, facet_probability(s, v));
#if SHEEN
    pdf = mix(pdf, sheen_pdf(v.sheen, a), sheen_probability(s, v));
#endif
    return vec4(f * wi.z, pdf);
}

// Of a direction that is no mirror's, weight and pdf are still those of nothing.
BsdfSample base_sample(Surface s, SurfaceView v, vec3 wo, vec3 u, sampler2D dfg) {
    if (wo.z <= 0.0) return NO_SAMPLE;
    float p = facet_probability(s, v);
    vec3 wi;
#if SHEEN
    float p_sheen = sheen_probability(s, v);
    if (u.z < p_sheen) return BsdfSample(sheen_sample(v.sheen, wo, u.xy), vec3(0.0), 0.0, REFLECTION, 1.0);
    u.z = min((u.z - p_sheen) / max(1.0 - p_sheen, 1e-6), 1.0 - 1.0 / 16777216.0);
#endif
    if (u.z >= p) {
#if DIFFUSE_TRANSMISSION
        if (u.z - p < (1.0 - p) * below_probability(s, v))
            return BsdfSample(-sample_cosine_hemisphere(u.xy), vec3(0.0), 0.0, TRANSMISSION, 1.0);
#endif
        wi = sample_diffuse(s, wo, u.xy);
    } else if (is_mirror(s)) {
        vec3 F = MIX_METAL(s, dielectric_facets(s, v, wo.z), metal_facets(v, wo.z));
#if SHEEN
        p *= 1.0 - p_sheen;
        F *= v.sheen.throughput;
#endif
        return BsdfSample(vec3(-wo.xy, wo.z), F * float(SHOW_SPECULAR) / p, p, REFLECTION | DELTA, 1.0);
    } else {
        vec3 h = sample_facet(s, wo, u.xy);
        wi = normalize(2.0 * dot(wo, h) * h - wo);
    }
    if (wi.z <= 0.0) return NO_SAMPLE;
    return BsdfSample(wi, vec3(0.0), 0.0, REFLECTION, 1.0);
}

// xyz: f |cos|, w: the pdf of surface_sample, both without mirrors
vec4 surface_eval_pdf(Surface s, SurfaceView v, vec3 wo, vec3 wi, sampler2D dfg) {
    vec4 f = base_eval_pdf(s, v, wo, wi, dfg);
#if CLEARCOAT
    f = coat_eval_pdf(v.coat, wo, wi, f, dfg);
#endif
    return f;
}

// As surface_sample, but of a direction that is no mirror's weight and pdf are still those of nothing.
BsdfSample surface_direction(Surface s, SurfaceView v, vec3 wo, vec3 u, sampler2D dfg) {
#if CLEARCOAT
    BsdfSample b;
    bool is_coat = coat_is_chosen(v.coat, u);
    if (is_coat) b = coat_sample(v.coat, wo, u.xy);
    else b = base_sample(s, v, wo, u, dfg);
    if ((b.flags & DELTA) != 0u) return coat_delta(v.coat, is_coat, b);
    return b;
#else
    return base_sample(s, v, wo, u, dfg);
#endif
}

BsdfSample surface_sample(Surface s, SurfaceView v, vec3 wo, vec3 u, sampler2D dfg) {
    BsdfSample b = surface_direction(s, v, wo, u, dfg);
    if (b.flags == 0u || (b.flags & DELTA) != 0u) return b;
    vec4 f = surface_eval_pdf(s, v, wo, b.wi, dfg);
    return BsdfSample(b.wi, f.rgb / max(f.w, 1e-30), f.w, b.flags, 1.0);
}

const vec3 SURFACE_NORMAL = vec3(0.0, 0.0, 1.0);

vec3 surface_eval(Surface m, vec3 wo, vec3 wi, sampler2D dfg) {
    if (wi.z == 0.0) return vec3(0.0);
    return surface_eval_pdf(m, surface_view(m, wo, SURFACE_NORMAL, dfg), wo, wi, dfg).rgb / abs(wi.z);
}

float surface_pdf(Surface m, vec3 wo, vec3 wi, sampler2D dfg) {
    return surface_eval_pdf(m, surface_view(m, wo, SURFACE_NORMAL, dfg), wo, wi, dfg).w;
}

BsdfSample surface_sample(Surface m, vec3 wo, vec3 u, sampler2D dfg) {
    return surface_sample(m, surface_view(m, wo, SURFACE_NORMAL, dfg), wo, u, dfg);
}

// That of a stretched lobe depends on the azimuth: the one between both axes stands for all.
vec3 surface_albedo(Surface m, float NoV, sampler2D dfg) {
    float x = sqrt(0.5 * max(1.0 - NoV * NoV, 0.0));
    SurfaceView v = surface_view(m, vec3(x, x, NoV), SURFACE_NORMAL, dfg);
    vec3 albedo = base_albedo(m, v);
#if CLEARCOAT
    albedo = coat_over(v.coat, coat_albedo(v.coat), albedo);
#endif
    return albedo;
}
