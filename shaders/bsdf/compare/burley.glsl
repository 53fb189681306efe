// f = rho / pi (1 + X (1 - NoL)^5) (1 + X (1 - NoV)^5),  X = F90 - 1 = 2 r LoH^2 - 1/2,  r perceptual roughness
// Burley 2012, "Physically Based Shading at Disney", section 5.3. It does not conserve energy: at grazing angles its
// albedo is 1.5 for r = 1 and 0.5 for r = 0.
#include "bsdf/bsdf.glsl"
#include "bsdf/fresnel.glsl"
#include "sample/hemisphere.glsl"

struct Burley {
    vec3 albedo;
    float perceptual_roughness;
};

// 2 LoH^2 = 1 + LoV
vec3 burley_eval(Burley m, vec3 wo, vec3 wi) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return vec3(0.0);
    float X = m.perceptual_roughness * (1.0 + dot(wo, wi)) - 0.5;
    return m.albedo * (INV_PI * (1.0 + X * pow5(max(1.0 - wi.z, 0.0))) * (1.0 + X * pow5(max(1.0 - wo.z, 0.0))));
}

float burley_pdf(Burley m, vec3 wo, vec3 wi) {
    return wo.z > 0.0 ? pdf_cosine_hemisphere(wi) : 0.0;
}

BsdfSample burley_sample(Burley m, vec3 wo, vec3 u) {
    vec3 wi = sample_cosine_hemisphere(u.xy);
    if (wo.z <= 0.0 || wi.z <= 0.0) return NO_SAMPLE;
    return BsdfSample(wi, PI * burley_eval(m, wo, wi), pdf_cosine_hemisphere(wi), REFLECTION, 1.0);
}

// The albedo is a polynomial in the cosines. With c = NoV, a = NoL, s = (1 - .)^5, and averages over the azimuth:
//   <X> = r (1 + a c) - 1/2,   <X^2> = r^2 ((1 + a c)^2 + (1 - a^2)(1 - c^2) / 2) - r (1 + a c) + 1/4,
//   E = rho int (1 + <X> (s_a + s_c) + <X^2> s_a s_c) 2 a da
// with int 2 a s_a = 1/21, int 2 a^2 s_a = 1/84, int 2 a^3 s_a = 1/252, int 2 a = 1, int 2 a^2 = 2/3.
vec3 burley_albedo(Burley m, float NoV) {
    float r = m.perceptual_roughness, c = NoV, c2 = c * c;
    float s_c = pow5(max(1.0 - c, 0.0));
    float first = (r - 0.5) * (1.0 / 21.0 + s_c) + r * c * (1.0 / 84.0 + s_c * (2.0 / 3.0));
    float second = (r * r * (1.5 - 0.5 * c2) - r + 0.25) / 21.0 + (2.0 * r * r - r) * c / 84.0
                 + r * r * (1.5 * c2 - 0.5) / 252.0;
    return m.albedo * (1.0 + first + s_c * second);
}
