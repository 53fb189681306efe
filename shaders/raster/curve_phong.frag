// Phong's model of curves (shaders/bsdf/kajiya_kay.glsl), under the same lights as that of surfaces, phong.frag:
//   L = k_a (k_d + k_s) + sum over lights of (k_d / pi^2 + k_s f(shininess)) E cos theta_i
// k_d is the colour of many such fibres together, k_s is f0, and k_a is the ambient irradiance / pi.
#include "raster/curve_shade.glsl"
#include "bsdf/fresnel.glsl"
#include "bsdf/kajiya_kay.glsl"

uniform vec3 u_fibre; // the factor of the root of sigma_a; shininess; index of refraction
#if HAS_ENVIRONMENT
uniform vec3 u_ambient; // irradiance
#endif

void main() {
    CurvePoint at;
    if (!curve_point(at)) discard;
    CurveFrame c = curve_frame(at);
    vec3 k_d = exp(-u_fibre.x * sqrt(absorption())) * float(SHOW_DIFFUSE); // sigma_a_of_color in viewer/scene/fibre.py
    float k_s = f0_from_eta(u_fibre.z) * float(SHOW_SPECULAR);

    vec3 radiance = vec3(0.0);
#if MEDIA
    MediaLight around = light_around(at.position, vec3(0.0));
    vec3 ambient = around.scattered;
#if HAS_ENVIRONMENT
    ambient += u_ambient * INV_PI * around.sky;
#endif
    radiance += (k_d + k_s) * ambient;
#elif HAS_ENVIRONMENT
    radiance += (k_d + k_s) * u_ambient * INV_PI;
#endif
#if LIGHT_COUNT > 0
    for (int i = 0; i < LIGHT_COUNT; ++i) {
        vec3 l, irradiance = light_before_shadow(i, at, l);
#if SHADOW_LAYERS > 0
        if (has_shadow(i)) irradiance *= seen_by_light(i, at, l);
#endif
        vec2 theta_i = vec2(length(l - c.axes[0] * dot(l, c.axes[0])), dot(l, c.axes[0]));
        float highlight = f_kajiya_kay(theta_i, vec2(c.cosine, c.sine), u_fibre.y);
        radiance += (k_d * f_kajiya_kay_diffuse() + k_s * highlight) * irradiance * theta_i.x;
    }
#endif
    write_curve(radiance, at);
}
