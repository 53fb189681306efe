// The light sample of a surface: one of several candidates, chosen in proportion to what each of them brings if nothing
// hides its light (resampled importance sampling: Talbot, Cline & Egbert 2005, "Importance Resampling for Global
// Illumination"). It stands for their mean, so that only shadows are as noisy as with a single one. Each candidate has
// the density of sample_light; they need not be independent, and are opposite in the square of u. Beside one sample of
// the BSDF they weigh as many as they are (the balance heuristic has n p of each technique), so that the
// densities of the BSDF are divided by `count`.
#include "sample/luminance.glsl"

struct SurfaceLight {
    LightSample light;
    vec3 f_cos; // the BSDF times the cosine, for as many candidates as the sample stands for
    float pdf;  // with which BSDF sampling would choose the direction, over `count`
    float side; // of the surface, 0: there is no sample
};

// u.xyz sample lights, u.w chooses among `count` of them: one or two, since for more it would take a number for each.
SurfaceLight sample_light_at(Interaction i, Bsdf bsdf, mat3 frame, vec3 wo, vec3 n_light, vec4 u, int count) {
    SurfaceLight chosen;
    chosen.side = 0.0;
    float sum = 0.0, own = 0.0;
    int k = 0;
    do { // where its condition comes first, llvmpipe runs a loop's body once more
        LightSample light = sample_light(i.position, n_light, vec3(fract(u.xy + 0.5 * float(k)), u.z));
        vec3 wi = light.direction * frame;
        float side = side_of(i, light.direction, wi.z);
        if (side == 0.0 || light.pdf <= 0.0) continue;
        vec4 f = bsdf_eval_pdf(bsdf, wo, wi);
        f.w /= float(count);
        float brings = luminance(f.rgb * light.radiance) * weight_of(light, f.w) / light.pdf;
        sum += brings;
        if (count > 1 && u.w * sum >= brings) continue;
        own = brings;
        chosen = SurfaceLight(light, f.rgb, f.w, side);
    } while (++k < count);
    if (count > 1) chosen.f_cos *= sum / (float(count) * own);
    return chosen;
}
