// What glass does with light at an interaction: a solid, into and out of which light is refracted, or a thin wall.
// KHR_materials_transmission, KHR_materials_volume, KHR_materials_specular.
#include "bsdf/bsdf.glsl"
#include "bsdf/fresnel.glsl"
#include "bsdf/surface_of.glsl"
#if HAS_SOLID_GLASS
#include "bsdf/lobe/dielectric.glsl"
#endif
#if HAS_THIN_GLASS
#include "bsdf/lobe/thin_dielectric.glsl"
#endif

struct Glass {
    float eta;    // index beyond the surface over that on wo's side; of a wall, over what is about it
    vec2 alpha;
    bool is_thin;
    vec3 tint;    // of what goes through
    vec3 f0, f90; // of the front
};

// The base colour tints what passes through a body once, half of it on the way in and half on the way out, so it is
// the same both ways; a wall has it all.
Glass glass_of(MaterialInputs m, bool is_thin, bool is_front) {
    Glass g = Glass(m.ior, both_alphas(surface_of(m)), is_thin, m.base_color.rgb, vec3(0.0), vec3(1.0));
    if (!is_thin) {
        g.tint = sqrt(max(m.base_color.rgb, vec3(0.0)));
        if (!is_front) g.eta = 1.0 / m.ior;
    }
#if HAS_SPECULAR_GLASS
    g.f0 = min(f0_from_eta(m.ior) * m.specular_color, vec3(1.0)) * m.specular;
    g.f90 = vec3(m.specular);
#endif
    return g;
}

// What `specular` and `specular_color` make of the light that the lobe sends to wi: Fresnel's curve from f0 to f90 in
// place of its own, which goes to 1. What is reflected totally stays.
vec3 interface_tint(Glass g, vec3 wo, vec3 wi) {
#if HAS_SPECULAR_GLASS
    float own_f0 = f0_from_eta(g.eta);
    vec3 across = wo + (g.is_thin || wi.z > 0.0 ? vec3(wi.xy, abs(wi.z)) : g.eta * wi);
    float R = f_dielectric(min(abs(dot(wo, across)) / max(length(across), 1e-18), 1.0), g.eta);
    if (R >= 1.0) return vec3(1.0);
    vec3 tinted = mix(g.f0, g.f90, clamp((R - own_f0) / max(1.0 - own_f0, 1e-6), 0.0, 1.0));
    if (g.is_thin) {
        R = 2.0 * R / (1.0 + R);
        tinted = 2.0 * tinted / (1.0 + tinted);
    }
    return wi.z > 0.0 ? tinted / max(R, 1e-18) : (1.0 - tinted) / (1.0 - R);
#else
    return vec3(1.0);
#endif
}

vec3 glass_tint(Glass g, vec3 wo, vec3 wi) {
    return interface_tint(g, wo, wi) * (wi.z < 0.0 ? g.tint : vec3(1.0)) * float(SHOW_SPECULAR);
}

// f and the sampling's pdf, without what is smooth
vec4 glass_eval_pdf(Glass g, vec3 wo, vec3 wi, sampler2D dfg) {
    vec4 f = vec4(0.0);
#if HAS_SOLID_GLASS
    if (!g.is_thin) {
        Dielectric lobe = Dielectric(g.eta, g.alpha);
        f = vec4(dielectric_eval(lobe, wo, wi, dfg), dielectric_pdf(lobe, wo, wi, dfg));
    }
#endif
#if HAS_THIN_GLASS
    if (g.is_thin) {
        ThinDielectric lobe = ThinDielectric(g.eta, g.alpha);
        f = vec4(thin_dielectric_eval(lobe, wo, wi, dfg), thin_dielectric_pdf(lobe, wo, wi, dfg));
    }
#endif
    return f * vec4(glass_tint(g, wo, wi), 1.0);
}

BsdfSample glass_sample(Glass g, vec3 wo, vec3 u, sampler2D dfg) {
    BsdfSample s = NO_SAMPLE;
#if HAS_SOLID_GLASS
    if (!g.is_thin) s = dielectric_sample(Dielectric(g.eta, g.alpha), wo, u, dfg);
#endif
#if HAS_THIN_GLASS
    if (g.is_thin) s = thin_dielectric_sample(ThinDielectric(g.eta, g.alpha), wo, u, dfg);
#endif
    s.weight *= glass_tint(g, wo, s.wi);
    return s;
}
