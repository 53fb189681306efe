// Masking and shadowing of GGX facets for reflection and transmission.
//   MASKING: 1 Smith separable, G2 = G1(o) G1(i); otherwise Smith height-correlated
#include "bsdf/beta.glsl"
#include "bsdf/ggx_local.glsl"

// V = G2 / (4 NoV NoL) for directions on the same side; separable: 1 / ((NoV + T_o) (NoL + T_i))
float v_masked_ggx(vec3 wo, vec3 wi, vec2 alpha) {
#if MASKING == 1
    return 1.0 / ((wo.z + smith_t(wo, alpha)) * (wi.z + smith_t(wi, alpha)));
#else
    return v_smith_ggx_local(wo, wi, alpha);
#endif
}

// G2 for transmission. Height-correlated: B(1 + Lambda_o, 1 + Lambda_i), B being Euler's beta function (Heitz et al.
// 2016, "Multiple-Scattering Microfacet BSDFs with the Smith Model"). The formula for reflection, 1 / (1 + Lambda_o +
// Lambda_i), would create energy here.
float g2_transmission_ggx(float lambda_o, float lambda_i) {
#if MASKING == 1
    return 1.0 / ((1.0 + lambda_o) * (1.0 + lambda_i));
#else
    return beta(1.0 + lambda_o, 1.0 + lambda_i);
#endif
}

// f cos / pdf for F = 1, of a direction reflected at a visible normal sampled with this cap bound
// (visible_normal.glsl):
//   2 V NoL (bound NoV + T_o)
float masked_reflection_weight(vec3 wo, vec3 wi, vec2 alpha, float bound) {
    return 2.0 * v_masked_ggx(wo, wi, alpha) * wi.z * (bound * wo.z + smith_t(wo, alpha));
}
