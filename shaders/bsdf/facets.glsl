// The microfacets of a surface. They are isotropic, with the factors that the switches of microfacet.glsl choose, or
// (ANISOTROPIC) anisotropic GGX. The other distributions are isotropic only.
#include "bsdf/bsdf.glsl"
#include "bsdf/half_vector.glsl"
#if ANISOTROPIC
#include "bsdf/ggx_masking.glsl"
#include "bsdf/visible_normal.glsl"
#include "light/stretched_dfg.glsl"
#endif
#include "light/dfg.glsl"

struct Surface {
    vec3 base_color;
    float metallic;
    vec3 f0;       // of the dielectric
    float f90;
    float ior;     // index of refraction for FRESNEL = 1, where f0 also contains weight and tint
    float alpha;   // below DELTA_ALPHA a mirror; if ANISOTROPIC, the alpha along the bitangent
    float alpha_t; // if ANISOTROPIC, the alpha along the tangent
    float film;           // if IRIDESCENT, the weight of a film, its index, its thickness in nm, and the share of light
    float film_ior, film_thickness, film_walls; // that meets it on both faces of a thin wall (bsdf/film.glsl)
    float diffuse_roughness; // if DIFFUSE_ROUGH, sigma of the diffuse base
    float diffuse_transmission;     // if DIFFUSE_TRANSMISSION, the share of the diffuse base's light that passes it
    vec3 diffuse_transmission_color;
    float scattered_back; // if THIN_SCATTER, the share of what the diffuse base keeps that has this colour, too
    float coat, coat_alpha; // if CLEARCOAT, the weight of the clear coat and its alpha
    vec3 sheen_color;       // if SHEEN
    float sheen_roughness;  // if SHEEN, perceptual
};

// The cosines of one reflection; D, G and F are functions of them.
struct Angles {
    float NoV, NoL, NoH, VoH;
    float s2; // |n x h|^2
#if ANISOTROPIC
    vec3 wo, wi, h; // in the local frame: x is the tangent, z the normal
#endif
};

// From wo and wi in the local frame
Angles local_angles(vec3 wo, vec3 wi) {
    vec3 h = normalize(wo + wi);
    float VoH = clamp(dot(wo, h), 0.0, 1.0);
#if ANISOTROPIC
    return Angles(wo.z, wi.z, h.z, VoH, dot(h.xy, h.xy), wo, wi, h);
#else
    return Angles(wo.z, wi.z, h.z, VoH, dot(h.xy, h.xy));
#endif
}

vec2 both_alphas(Surface s) {
#if ANISOTROPIC
    return vec2(s.alpha_t, s.alpha);
#else
    return vec2(s.alpha);
#endif
}

// alpha of the isotropic lobe that replaces an anisotropic one: both have the same D along the normal.
float mean_alpha(Surface s) {
#if ANISOTROPIC
    return sqrt(s.alpha_t * s.alpha);
#else
    return s.alpha;
#endif
}

bool is_mirror(Surface s) {
    return is_delta(both_alphas(s));
}

// The perceptual roughness with which the DFG table is read
float table_roughness(Surface s) {
    return is_mirror(s) ? 0.0 : sqrt(mean_alpha(s));
}

// (a, b) of the split sum for a direction above the surface. Only a stretched lobe looks at x and y, in the local
// frame.
vec2 facet_albedo(Surface s, vec3 w, float perceptual_roughness, sampler2D dfg) {
#if ANISOTROPIC
    return stretched_albedo(dfg, both_alphas(s), w);
#else
    return dfg_albedo(dfg, w.z, perceptual_roughness);
#endif
}

// Their means over the hemisphere
vec2 facet_mean(Surface s, float perceptual_roughness, sampler2D dfg) {
#if ANISOTROPIC
    return stretched_mean(dfg, both_alphas(s));
#else
    return dfg_mean(dfg, perceptual_roughness);
#endif
}

float facet_d(Surface s, Angles a) {
#if ANISOTROPIC
    return d_ggx_local(a.h, finite_alpha(both_alphas(s)));
#else
    return d_microfacet(a.NoH, a.s2, s.alpha);
#endif
}

// V = G2 / (4 NoV NoL); MASKING 2 and 3 depend on the cosines alone.
float facet_v(Surface s, Angles a) {
#if ANISOTROPIC && MASKING < 2
    return v_masked_ggx(a.wo, a.wi, finite_alpha(both_alphas(s)));
#else
    return v_microfacet(a.NoV, a.NoL, a.NoH, a.VoH, s.alpha);
#endif
}

vec3 sample_facet(Surface s, vec3 wo, vec2 u) {
#if ANISOTROPIC
    vec2 a = finite_alpha(both_alphas(s));
    return sample_visible_normal(wo, a, cap_bound(wo, a), u);
#else
    return sample_half(wo, s.alpha, u);
#endif
}

// Density of the direction reflected at h, with respect to solid angle
float pdf_facet_reflection(Surface s, vec3 wo, vec3 h) {
#if ANISOTROPIC
    vec2 a = finite_alpha(both_alphas(s));
    return pdf_visible_reflection(wo, h, a, cap_bound(wo, a));
#else
    return pdf_half_reflection(wo, h, s.alpha);
#endif
}
