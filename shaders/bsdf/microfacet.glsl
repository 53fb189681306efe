// The factors D and V of the Cook-Torrance lobe f = D V F, which switches choose.
//   NDF:     0 GGX, 1 Beckmann, 2 Blinn-Phong
//   MASKING: 0 Smith height-correlated, 1 Smith separable, 2 V-cavity, 3 none
#if NDF == 0
#include "bsdf/ggx.glsl"
#else
#include "bsdf/beckmann.glsl"
#endif
#if NDF == 2
#include "bsdf/blinn_phong.glsl"
#endif
#if MASKING >= 2
#include "bsdf/v_cavity.glsl"
#endif

// s2 = |n x h|^2
float d_microfacet(float NoH, float s2, float alpha) {
#if NDF == 0
    return d_ggx(NoH, s2, alpha);
#elif NDF == 1
    return d_beckmann(NoH, s2, alpha);
#else
    return d_blinn_phong(NoH, s2, alpha);
#endif
}

// V = G2 / (4 NoV NoL). Blinn-Phong has no Smith function in closed form; it uses that of Beckmann, a similar
// distribution (Walter et al. 2007, section 5.2).
float v_microfacet(float NoV, float NoL, float NoH, float VoH, float alpha) {
#if MASKING == 2
    return v_cavity(NoV, NoL, NoH, VoH);
#elif MASKING == 3
    return v_none(NoV, NoL);
#elif NDF == 0 && MASKING == 0
    return v_smith_ggx(NoV, NoL, alpha);
#elif NDF == 0
    return v_smith_separable_ggx(NoV, NoL, alpha);
#elif MASKING == 0
    return v_smith_beckmann(NoV, NoL, alpha);
#else
    return v_smith_separable_beckmann(NoV, NoL, alpha);
#endif
}
