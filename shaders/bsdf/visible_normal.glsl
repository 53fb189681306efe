// Samples the distribution of visible normals, D_v(h) = G1(wo) max(wo.h, 0) D(h) / NoV (Heitz & d'Eon 2014), by uniform
// points c on a spherical cap: Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps".
//   v = norm(alpha_t ox, alpha_b oy, oz),   z = (1 - u2)(1 + floor) - floor,   h ~ (alpha (c + v).xy, (c + v).z)
// A cap down to z = -vz contains all visible normals. For reflection Eto & Tokuyoshi 2023, "Bounded VNDF Sampling for
// Smith-GGX Reflections", end the cap at z = -k vz: normals below only reflect light under the surface.
#include "bsdf/ggx_local.glsl"

// k = (1 - a^2) s^2 / (s^2 + a^2 oz^2),  a = min(alpha_t, alpha_b, 1),  s = 1 + |o_xy|
float cap_bound(vec3 wo, vec2 alpha) {
    float a = min(min(alpha.x, alpha.y), 1.0);
    float s = 1.0 + length(wo.xy);
    float a2 = a * a, s2 = s * s;
    return (1.0 - a2) * s2 / (s2 + a2 * wo.z * wo.z);
}

// h from a cap down to -bound vz; bound = 1 gives all visible normals. wo.z > 0, so c + v is not 0.
vec3 sample_visible_normal(vec3 wo, vec2 alpha, float bound, vec2 u) {
    vec3 v = normalize(vec3(alpha * wo.xy, wo.z));
    float floor_z = bound * v.z;
    float z = (1.0 - u.y) * (1.0 + floor_z) - floor_z;
    float phi = 2.0 * PI * u.x;
    vec3 c = vec3(sqrt(clamp(1.0 - z * z, 0.0, 1.0)) * vec2(cos(phi), sin(phi)), z) + v;
    return normalize(vec3(alpha * c.xy, c.z));
}

// The density D_v(h) = 2 VoH D / (NoV + T_o) of all visible normals, in a form without a division by NoV
float pdf_visible_normal(vec3 wo, vec3 h, vec2 alpha) {
    return 2.0 * max(dot(wo, h), 0.0) * d_ggx_local(h, alpha) / (wo.z + smith_t(wo, alpha));
}

// Density of the direction reflected at h, D_v / (4 VoH) for a cap down to -bound vz:   D / (2 (bound NoV + T_o))
float pdf_visible_reflection(vec3 wo, vec3 h, vec2 alpha, float bound) {
    return 0.5 * d_ggx_local(h, alpha) / (bound * wo.z + smith_t(wo, alpha));
}
