// Phong's highlight about the mirror direction r of wo, as first published and as a BRDF.
//   plain_phong: f = k_s (r.wi)^s / NoL: the reflected light is k_s (r.wi)^s for any angle of incidence. Phong 1975,
//                "Illumination for Computer Generated Pictures". Not reciprocal, and for s < 5 its albedo exceeds 1.
//   phong:       f = k_s (s + 2) / (2 pi) (r.wi)^s. Lafortune & Willems 1994, "Using the Modified Phong
//                Reflectance Model for Physically Based Rendering". The part of the lobe below the horizon is lost.
#include "bsdf/accurate.glsl"
#include "bsdf/bsdf.glsl"
#include "bsdf/phong.glsl"
#include "sample/lattice.glsl"
#include "sample/orthonormal_basis.glsl"

struct Phong {
    vec3 specular; // k_s
    float shininess;
};

vec3 phong_mirror(vec3 wo) {
    return vec3(-wo.xy, wo.z);
}

// p = (s + 1) / (2 pi) (r.wi)^s
float phong_pdf(Phong m, vec3 wo, vec3 wi) {
    float RoL = dot(phong_mirror(wo), wi);
    if (wo.z <= 0.0 || wi.z <= 0.0 || RoL <= 0.0) return 0.0;
    return (m.shininess + 1.0) * 0.5 * INV_PI * pow(RoL, m.shininess);
}

// A direction with density phong_pdf, whether above the surface or not: cos(angle to r) = (1 - u)^(1 / (s + 1))
vec3 phong_direction(Phong m, vec3 wo, vec2 u) {
    float sin2 = one_minus_exp_fast(-2.0 * log(1.0 - u.x) / (m.shininess + 1.0));
    float phi = 2.0 * PI * u.y;
    vec3 local = vec3(sqrt(sin2) * vec2(cos(phi), sin(phi)), sqrt(1.0 - sin2));
    return orthonormal_basis(phong_mirror(wo)) * local;
}

vec3 phong_eval(Phong m, vec3 wo, vec3 wi) {
    if (wo.z <= 0.0 || wi.z <= 0.0) return vec3(0.0);
    return m.specular * f_phong(dot(phong_mirror(wo), wi), m.shininess);
}

BsdfSample phong_sample(Phong m, vec3 wo, vec3 u) {
    vec3 wi = phong_direction(m, wo, u.xy);
    if (wo.z <= 0.0 || wi.z <= 0.0) return NO_SAMPLE;
    vec3 weight = m.specular * ((m.shininess + 2.0) / (m.shininess + 1.0) * wi.z);
    return BsdfSample(wi, weight, phong_pdf(m, wo, wi), REFLECTION, 1.0);
}

// Directional albedo from 64 samples; the error is at most 0.01.
vec3 phong_albedo(Phong m, float NoV) {
    vec3 wo = vec3(sqrt(max(1.0 - NoV * NoV, 0.0)), 0.0, NoV);
    float sum = 0.0;
    for (uint i = 0u; i < 64u; ++i) sum += max(phong_direction(m, wo, hammersley(i, 64u)).z, 0.0);
    return m.specular * ((m.shininess + 2.0) / (m.shininess + 1.0) * sum / 64.0);
}

vec3 plain_phong_eval(Phong m, vec3 wo, vec3 wi) {
    float RoL = dot(phong_mirror(wo), wi);
    if (wo.z <= 0.0 || wi.z <= 0.0 || RoL <= 0.0) return vec3(0.0);
    return m.specular * (pow(RoL, m.shininess) / wi.z);
}

float plain_phong_pdf(Phong m, vec3 wo, vec3 wi) {
    return phong_pdf(m, wo, wi);
}

BsdfSample plain_phong_sample(Phong m, vec3 wo, vec3 u) {
    BsdfSample s = phong_sample(m, wo, u);
    s.weight = s.flags == 0u ? vec3(0.0) : m.specular * (2.0 * PI / (m.shininess + 1.0));
    return s;
}

// Directional albedo, from the fraction of 64 samples that is above the horizon; the error of the fraction is at most
// 0.01.
vec3 plain_phong_albedo(Phong m, float NoV) {
    vec3 wo = vec3(sqrt(max(1.0 - NoV * NoV, 0.0)), 0.0, NoV);
    float sum = 0.0;
    for (uint i = 0u; i < 64u; ++i) sum += phong_direction(m, wo, hammersley(i, 64u)).z > 0.0 ? 1.0 : 0.0;
    return m.specular * (2.0 * PI / (m.shininess + 1.0) * sum / 64.0);
}
