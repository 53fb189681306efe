// Phong's model: ambient, diffuse and a cosine-power highlight, with the same lights and maps as mode pbr.
//   L = k_a (k_d + k_s) + sum over lights of (k_d / pi + k_s f(shininess)) E NoL
// k_d = base colour (1 - metalness), k_s = base colour for metal, f0 otherwise; k_a is the ambient irradiance / pi.
#include "raster/material.glsl"
#include "raster/normal.glsl"
#if DEFERRED
#include "raster/deferred.glsl"
#endif
#include "bsdf/fresnel.glsl"
#include "bsdf/lambert.glsl"
#include "bsdf/phong.glsl"
#if LIGHT_COUNT > 0
#include "light/punctual.glsl"
#endif
#if SHADOW_LAYERS > 0
#include "light/shadow.glsl"
#endif
#if MEDIA
#include "raster/lit_media.glsl"
#endif
#if IS_ORTHOGRAPHIC
uniform vec3 u_view_direction; // towards the eye
#endif

#if HAS_ENVIRONMENT
uniform vec3 u_ambient; // irradiance
#endif
#if HAS_SHININESS
uniform float u_shininess;
#endif

void main() {
#if DEFERRED
    find_surface();
#endif
    MaterialInputs m = read_inputs();
    float covered = coverage(m.base_color.a);
    vec3 n_geometric = geometric_normal();
    vec3 n = shading_normal(n_geometric);
    vec3 v = -normalize(v_position);
#if IS_ORTHOGRAPHIC
    v = u_view_direction;
#endif
#if HAS_SHININESS
    float shininess = u_shininess;
#else
    // alpha = sqrt(2 / (shininess + 2)), alpha the square of perceptual roughness
    float alpha = max(m.perceptual_roughness, MIN_PERCEPTUAL_ROUGHNESS);
    alpha *= alpha;
    float shininess = max(2.0 / (alpha * alpha) - 2.0, 0.0);
#endif
    vec3 k_d = m.base_color.rgb * (1.0 - m.metallic);
    vec3 k_s = mix(min(f0_from_eta(m.ior) * m.specular_color, 1.0) * m.specular, m.base_color.rgb, m.metallic);

    vec3 radiance = vec3(0.0);
#if SHOW_EMISSION
    radiance += m.emissive;
#endif
#if HAS_ENVIRONMENT || MEDIA
    float occlusion = 1.0;
#if OCCLUSION_MAP
    occlusion = 1.0 + u_occlusion_strength * (occlusion_texel().r - 1.0);
#endif
    vec3 reflected = k_d * float(SHOW_DIFFUSE) + k_s * float(SHOW_SPECULAR);
#endif
#if HAS_ENVIRONMENT && !MEDIA
    radiance += reflected * u_ambient * (INV_PI * occlusion);
#elif MEDIA
    MediaLight around = light_around(v_position, vec3(0.0));
    vec3 ambient = around.scattered;
#if HAS_ENVIRONMENT
    ambient += u_ambient * INV_PI * around.sky;
#endif
    radiance += reflected * ambient * occlusion;
#endif
#if LIGHT_COUNT > 0
    int i = 0;
    do {
        vec3 l;
        vec3 irradiance = punctual_irradiance(i, v_position, l);
        float NoL = dot(n, l);
        if (NoL <= 0.0) continue;
#if SHADOW_LAYERS > 0
        float layer = u_lights[i].direction.w;
        if (layer >= 0.0) {
            bool is_point = i >= DIRECTIONAL_COUNT && i < DIRECTIONAL_COUNT + POINT_COUNT;
            irradiance *= shadow_visibility(int(layer), is_point, v_position, n_geometric, l, u_lights[i].position.xyz);
        }
#endif
#if MEDIA
        irradiance *= transmittance_to_light(i, v_position, l);
#endif
#if BLINN
        float highlight = f_blinn(dot(n, normalize(v + l)), shininess);
#else
        float highlight = f_phong(dot(reflect(-l, n), v), shininess);
#endif
        vec3 f = f_lambert(k_d) * float(SHOW_DIFFUSE) + k_s * (highlight * float(SHOW_SPECULAR));
        radiance += f * irradiance * NoL;
    } while (++i < LIGHT_COUNT);
#endif
    write_radiance(radiance, covered);
}
