// Cook-Torrance: the material of bsdf/standard.glsl under lights and an environment.
#include "raster/material.glsl"
#include "raster/normal.glsl"
#include "bsdf/microfacet.glsl"
#include "bsdf/standard.glsl"
#if SPECULAR_AA
#include "bsdf/specular_aa.glsl"
#endif
#include "light/dfg.glsl"
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif
#if VISIBILITY
#include "raster/visibility.glsl"
#endif
#if TRACED_REFLECTION
#include "raster/traced_reflection.glsl"
#endif
#if TRACED_REFRACTION
#include "raster/traced_refraction.glsl"
#endif
#if LIGHT_COUNT > 0
#include "light/punctual.glsl"
#endif
#if SUNS
#include "light/sun.glsl"
#endif
#if SHADOW_LAYERS > 0
#include "light/shadow.glsl"
#endif
#if IS_ORTHOGRAPHIC
uniform vec3 u_view_direction; // towards the eye
#endif

// METALNESS: 0 all dielectric, 1 all metal, 2 a mixture. REFLECTS: 0 for a Lambertian surface, without any interface.
uniform sampler2D u_dfg;

struct Surface {
    vec3 n, v;
    float NoV;
    float perceptual_roughness, alpha;
    vec3 base_color;
    float metallic;
    float ior;
    Interface dielectric, metal;
};

vec3 dielectric_f0(float ior, float weight, vec3 tint) {
    float f0 = (ior - 1.0) / (ior + 1.0);
    return min(f0 * f0 * tint, 1.0) * weight;
}

#if LIGHT_COUNT > 0
#include "raster/shade_light.glsl"
#endif
#if HAS_ENVIRONMENT || INDIRECT
#include "raster/shade_environment.glsl"
#endif
#if HAS_TRANSMISSION
#include "raster/transmission.glsl"
#endif

void main() {
    MaterialInputs m = read_inputs();
    float covered = coverage(m.base_color.a);

    Surface s;
    vec3 n_geometric = geometric_normal();
    s.n = shading_normal(n_geometric);
    s.v = -normalize(v_position);
#if IS_ORTHOGRAPHIC
    s.v = u_view_direction;
#endif
    s.NoV = clamp(dot(s.n, s.v), 1e-4, 1.0);
    s.base_color = m.base_color.rgb;
    s.metallic = m.metallic;
    s.ior = m.ior;
#if HAS_TRANSMISSION
    float blur = transmitted_roughness(m.perceptual_roughness, m.ior);
#endif
    s.perceptual_roughness = clamp(m.perceptual_roughness, MIN_PERCEPTUAL_ROUGHNESS, 1.0);
    s.alpha = s.perceptual_roughness * s.perceptual_roughness;
#if SPECULAR_AA
    s.alpha = alpha_antialiased(s.alpha, dFdx(s.n), dFdy(s.n));
    s.perceptual_roughness = sqrt(s.alpha);
#endif

#if (HAS_ENVIRONMENT || INDIRECT) && REFLECTS
    SplitSum split_sum = dfg_lookup(u_dfg, s.NoV, s.perceptual_roughness);
    vec2 dfg = split_sum.albedo;
#elif REFLECTS
    vec2 dfg = dfg_albedo(u_dfg, s.NoV, s.perceptual_roughness);
#else
    const SplitSum split_sum = SplitSum(vec2(0.0), vec2(0.0), vec2(0.0));
    const vec2 dfg = vec2(0.0), dfg_over_hemisphere = vec2(0.0);
#endif
#if REFLECTS
    vec2 dfg_over_hemisphere = dfg_mean(u_dfg, s.perceptual_roughness);
#endif
#if METALNESS != 1
#if REFLECTS
    float weight = m.specular;
#else
    float weight = 0.0;
#endif
    vec3 f0 = dielectric_f0(m.ior, weight, m.specular_color);
#if HAS_TRANSMISSION && !IS_SOLID
    f0 = mix(f0, thin_walled_f0(f0), m.transmission);
#endif
    s.dielectric = make_interface(f0, vec3(weight), dfg, dfg_over_hemisphere);
#endif
#if METALNESS != 0
    s.metal = make_interface(s.base_color, vec3(1.0), dfg, dfg_over_hemisphere);
#endif

    vec3 radiance = vec3(0.0);
#if SHOW_EMISSION
    radiance += m.emissive;
#endif
#if HAS_TRANSMISSION
    float passes = transmitted(s.dielectric, dfg) * m.transmission * (METALNESS == 2 ? 1.0 - s.metallic : 1.0);
    vec3 arriving = light_from_behind(m, s.n, n_geometric, s.v, blur);
    radiance += passes * entering_tint(m.base_color.rgb) * arriving * float(SHOW_SPECULAR);
    s.base_color *= 1.0 - m.transmission; // what is left to scatter
#endif
#if HAS_ENVIRONMENT || INDIRECT
    float occlusion = 1.0;
#if OCCLUSION_MAP
    occlusion = 1.0 + u_occlusion_strength * (occlusion_texel().r - 1.0);
#endif
#if VISIBILITY
    vec4 visible = visibility(v_position, n_geometric);
#else
    const vec4 visible = vec4(1.0);
#endif
    radiance += shade_environment(s, n_geometric, occlusion, visible, split_sum);
#endif
#if LIGHT_COUNT > 0
    for (int i = 0; i < LIGHT_COUNT; ++i) radiance += shade_light(i, s, n_geometric);
#endif
    write_radiance(radiance, covered);
}
