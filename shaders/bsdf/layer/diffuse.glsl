// The diffuse base below a dielectric interface. SHOW_DIFFUSE = 0 hides it. DIFFUSE_ROUGH: 0 is Lambert's, 1 is EON
// (Portsmouth, Kutz & Hill 2024; KHR_materials_diffuse_roughness). With DIFFUSE_TRANSMISSION a share t of its light
// leaves as a cosine lobe on the other side (KHR_materials_diffuse_transmission):
//   f = (1 - t) f_diffuse above, t color / pi below
// With THIN_SCATTER a share b of what stays above has the colour of what leaves below (bsdf/thin_scatter.glsl):
//   f = (1 - t) ((1 - b) f_diffuse + b color / pi) above
#include "bsdf/facets.glsl"
#include "bsdf/lambert.glsl"
#include "bsdf/layer/interface.glsl"

// The share of the base's light that stays on its side
float shown_above(Surface s) {
#if DIFFUSE_TRANSMISSION
    return (1.0 - s.diffuse_transmission) * float(SHOW_DIFFUSE);
#else
    return float(SHOW_DIFFUSE);
#endif
}

#if DIFFUSE_TRANSMISSION
// The albedo of the lobe on the other side
vec3 transmitted_albedo(Surface s) {
    return s.diffuse_transmission * s.diffuse_transmission_color * float(SHOW_DIFFUSE);
}
#endif

// The albedo or f of the base, `own`, with what is scattered back; `white` is that of a white Lambertian base.
vec3 with_scattered_back(Surface s, vec3 own, float white) {
#if THIN_SCATTER
    return mix(own, white * s.diffuse_transmission_color, s.scattered_back);
#else
    return own;
#endif
}

#if DIFFUSE_ROUGH
#include "bsdf/eon.glsl"
#include "bsdf/eon_sample.glsl"

// The interface dims light that arrives at grazing angles: T(i) / T_mean = 1 - x ((1 - NoL)^5 - 1/21). On a whole, that
// leaves Lambert's albedo as it is. A rough base sends light back to where it came from, so under the interface its
// albedo would be larger by -x sigma A q(NoV), which this gives back for both directions: white stays white.
//   q(mu) = int ((1 - NoL)^5 - 1/21) f NoL dwi / (sigma A)      of white, by a polynomial, to 1e-4
float eon_dimming(float mu) {
    return 0.07583 + mu * (-0.30974 + mu * (0.47849 + mu * (-0.36511 + mu * 0.11237)));
}

vec3 diffuse_response(Surface s, Interface face, Angles a) {
    float LoV = 2.0 * a.VoH * a.VoH - 1.0;
    vec3 f = f_eon(s.base_color, s.diffuse_roughness, a.NoV, a.NoL, LoV);
    float returned = face.dimming * s.diffuse_roughness * eon_scale(s.diffuse_roughness);
    f += s.base_color * (INV_PI * returned * (eon_dimming(a.NoV) + eon_dimming(a.NoL)));
    return with_scattered_back(s, max(f, 0.0), INV_PI) * shown_above(s);
}

// f of the white base, the mean over all directions at the angle of cosine `mu`, over that of Lambert's. Of EON's s / t
// it is sin sin (1 / max(NoV, mu) - 1) / pi.
float diffuse_arriving(Surface s, Interface face, float NoV, float mu) {
    float sigma = s.diffuse_roughness, B = sigma * eon_scale(sigma);
    float returned = sqrt(max((1.0 - NoV * NoV) * (1.0 - mu * mu), 0.0)) * (1.0 / max(NoV, mu) - 1.0) * INV_PI;
    float lost = (1.0 - eon_single_albedo(NoV, sigma)) * (1.0 - eon_single_albedo(mu, sigma));
    float f = eon_scale(sigma) + B * (returned + face.dimming * (eon_dimming(NoV) + eon_dimming(mu)))
        + (sigma > 1e-4 ? lost / (1.0 - eon_mean_albedo(sigma)) : 0.0);
    return with_scattered_back(s, vec3(max(f, 0.0)), 1.0).g;
}

vec3 diffuse_albedo(Surface s, float NoV) {
    return with_scattered_back(s, eon_total_albedo(s.base_color, s.diffuse_roughness, NoV), 1.0) * shown_above(s);
}

vec3 sample_diffuse(Surface s, vec3 wo, vec2 u) {
    return sample_eon(wo, s.diffuse_roughness, u);
}

float pdf_diffuse(Surface s, vec3 wo, vec3 wi) {
    return pdf_eon(wo, wi, s.diffuse_roughness);
}

// The axis of the cosine lobe that stands for the base under an environment: along the mean int wi f NoL dwi of white,
// whose parts along the normal and towards the viewer are polynomials in NoV, to 2e-3.
vec3 diffuse_axis(Surface s, vec3 n, vec3 v, float NoV) {
    float B = s.diffuse_roughness * eon_scale(s.diffuse_roughness);
    float along = 2.0 / 3.0 + B * (-0.1056 + NoV * (0.2547 - NoV * 0.1283));
    float towards = B * (0.4604 - NoV * (0.2752 - NoV * 0.0628));
    return normalize((along - towards * NoV) * n + towards * v);
}
#else
#include "sample/hemisphere.glsl"

vec3 diffuse_response(Surface s, Interface face, Angles a) {
    return with_scattered_back(s, f_lambert(s.base_color), INV_PI) * shown_above(s);
}

vec3 diffuse_albedo(Surface s, float NoV) {
    return with_scattered_back(s, s.base_color, 1.0) * shown_above(s);
}

vec3 sample_diffuse(Surface s, vec3 wo, vec2 u) {
    return sample_cosine_hemisphere(u);
}

float pdf_diffuse(Surface s, vec3 wo, vec3 wi) {
    return pdf_cosine_hemisphere(wi);
}
#endif
