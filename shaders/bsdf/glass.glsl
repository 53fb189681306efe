// The BSDF of glass at one interaction: the interface of a solid, which refracts light, or a thin-walled surface.
// KHR_materials_transmission, KHR_materials_volume, KHR_materials_specular.
#include "bsdf/bsdf.glsl"
#include "bsdf/fresnel.glsl"
#include "bsdf/anisotropy.glsl"
#if HAS_ROUGH_GLASS && MULTISCATTER
#include "light/rough_glass.glsl"
#endif
#if HAS_SOLID_GLASS
#include "bsdf/lobe/dielectric.glsl"
#endif
#if HAS_THIN_GLASS
#include "bsdf/lobe/thin_dielectric.glsl"
#endif

struct Glass {
    float eta;    // index on the far side over that on wo's side; if thin-walled, of the wall over its surroundings
    vec2 alpha;
    bool is_thin;
    vec3 tint;    // of transmitted light
    vec3 f0, f90; // for light from outside
    float film, film_ior, film_thickness; // if IRIDESCENT, as in facets.glsl
};

// The base colour tints light that passes through a solid once in all: each of its two interfaces applies the square
// root, so the tint is the same in both directions. A thin-walled surface applies the base colour at once.
Glass glass_of(MaterialInputs m, bool is_thin, bool is_front) {
    Glass g;
    g.eta = m.ior;
    g.alpha = alphas_of(m);
    g.is_thin = is_thin;
    g.tint = m.base_color.rgb;
    g.f0 = vec3(f0_from_eta(m.ior));
    g.f90 = vec3(1.0);
    if (!is_thin) {
        g.tint = sqrt(max(m.base_color.rgb, vec3(0.0)));
        if (!is_front) g.eta = 1.0 / m.ior;
    }
#if HAS_SPECULAR_GLASS
    g.f0 = min(f0_from_eta(m.ior) * m.specular_color, vec3(1.0)) * m.specular;
    g.f90 = vec3(m.specular);
#endif
    g.film = m.iridescence;
    g.film_ior = m.iridescence_ior;
    g.film_thickness = m.iridescence_thickness_maximum;
    return g;
}

// The factor by which `specular` and `specular_color` (KHR_materials_specular) change the light that the lobe scatters
// to wi. It replaces the lobe's Fresnel reflectance R, which goes from f0 of the index to 1, by the same curve scaled
// to go from g.f0 to g.f90. Total internal reflection does not change. Below a film the lobes do this themselves.
vec3 interface_tint(Glass g, vec3 wo, vec3 wi) {
#if HAS_SPECULAR_GLASS && !IRIDESCENT
    float eta_f0 = f0_from_eta(g.eta);
    vec3 half_vector = wo + (g.is_thin || wi.z > 0.0 ? vec3(wi.xy, abs(wi.z)) : g.eta * wi); // not normalised
    float R = f_dielectric(min(abs(dot(wo, half_vector)) / max(length(half_vector), 1e-18), 1.0), g.eta);
    if (R >= 1.0) return vec3(1.0);
    vec3 tinted = mix(g.f0, g.f90, clamp((R - eta_f0) / max(1.0 - eta_f0, 1e-6), 0.0, 1.0));
    if (g.is_thin) {
        R = 2.0 * R / (1.0 + R);
        tinted = 2.0 * tinted / (1.0 + tinted);
    }
    return wi.z > 0.0 ? tinted / max(R, 1e-18) : (1.0 - tinted) / (1.0 - R);
#else
    return vec3(1.0);
#endif
}

// What the facets do not show of light that meets more than one of them. Those of a thin wall scatter all light.
float scattered_again(Glass g, vec3 wo, vec3 wi, sampler2D dfg) {
#if HAS_ROUGH_GLASS && MULTISCATTER
    if (is_delta(g.alpha)) return 1.0;
    float alpha = min(sqrt(g.alpha.x * g.alpha.y), 1.0), f0 = g.is_thin ? 1.0 : f0_from_eta(g.eta);
    // The factors are those of an interface that reflects by its index alone. On another they would make light.
#if IRIDESCENT
    if (!g.is_thin && g.film > 0.0) return 1.0;
#endif
#if HAS_SPECULAR_GLASS
    if (!g.is_thin && any(greaterThan(abs(vec4(g.f0, g.f90.x) - vec4(vec3(f0), 1.0)), vec4(1e-4)))) return 1.0;
#endif
    bool is_inside = !g.is_thin && g.eta < 1.0, is_crossing = !g.is_thin && wi.z < 0.0;
    return exp(rough_glass_factor(dfg, wo.z, alpha, f0, is_inside)
               + rough_glass_factor(dfg, wi.z, alpha, f0, is_inside != is_crossing));
#else
    return 1.0;
#endif
}

vec3 glass_tint(Glass g, vec3 wo, vec3 wi, sampler2D dfg) {
    return interface_tint(g, wo, wi) * (wi.z < 0.0 ? g.tint : vec3(1.0)) * float(SHOW_SPECULAR)
        * scattered_again(g, wo, wi, dfg);
}

#if HAS_SOLID_GLASS
Dielectric solid_lobe(Glass g) {
    return Dielectric(g.eta, g.alpha, g.f0, g.f90, g.film, g.film_ior, g.film_thickness);
}
#endif

#if HAS_THIN_GLASS
ThinDielectric thin_lobe(Glass g) {
    return ThinDielectric(g.eta, g.alpha, g.f0, g.f90, g.film, g.film_ior, g.film_thickness);
}
#endif

#if HAS_THIN_GLASS
// What a wall transmits straight on, at the cosine NoV: all that it transmits, if it is smooth; else nothing
vec3 wall_transmittance(Glass g, float NoV) {
    if (!is_delta(g.alpha)) return vec3(0.0);
    vec3 wo = vec3(sqrt(max(1.0 - NoV * NoV, 0.0)), 0.0, NoV);
    return (1.0 - f_thin(thin_lobe(g), NoV)) * interface_tint(g, wo, -wo) * g.tint;
}
#endif

// rgb: f, a: the pdf of glass_sample. Delta lobes are not included.
vec4 glass_eval_pdf(Glass g, vec3 wo, vec3 wi, sampler2D dfg) {
    vec4 f = vec4(0.0);
#if HAS_SOLID_GLASS
    if (!g.is_thin) {
        Dielectric lobe = solid_lobe(g);
        f = vec4(dielectric_eval(lobe, wo, wi, dfg), dielectric_pdf(lobe, wo, wi, dfg));
    }
#endif
#if HAS_THIN_GLASS
    if (g.is_thin) {
        ThinDielectric lobe = thin_lobe(g);
        f = vec4(thin_dielectric_eval(lobe, wo, wi, dfg), thin_dielectric_pdf(lobe, wo, wi, dfg));
    }
#endif
    return f * vec4(glass_tint(g, wo, wi, dfg), 1.0);
}

BsdfSample glass_sample(Glass g, vec3 wo, vec3 u, sampler2D dfg) {
    BsdfSample s = NO_SAMPLE;
#if HAS_SOLID_GLASS
    if (!g.is_thin) s = dielectric_sample(solid_lobe(g), wo, u, dfg);
#endif
#if HAS_THIN_GLASS
    if (g.is_thin) s = thin_dielectric_sample(thin_lobe(g), wo, u, dfg);
#endif
    s.weight *= glass_tint(g, wo, s.wi, dfg);
    return s;
}
