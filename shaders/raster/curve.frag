// Shades curves as fibres under lights and an environment.
#include "raster/curve_shade.glsl"
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif
#include "raster/curve_light.glsl"

uniform vec4 u_fibre; // beta_m, beta_n, tilt, index of refraction

#if LIGHT_COUNT > 0
vec3 light_on_fibre(int i, CurvePoint at, SeenFibre s, mat3 frame) {
    vec3 l, irradiance = light_before_shadow(i, at, l);
#if SHADOW_LAYERS > 0
    if (has_shadow(i)) {
        float seen = seen_by_light(i, at, l);
        vec3 wi = l * frame, response = seen > 0.0 ? seen * fibre_response(s, wi) : vec3(0.0);
#if HAIR_LIGHT
        if (seen < 1.0) {
            ThroughFibres t = light_through_fibres(i, at.position);
            response += (1.0 - seen) * t.share * response_through_fibres(s, wi, t.crossed);
        }
#endif
        return response * irradiance;
    }
#endif
    return fibre_response(s, l * frame) * irradiance;
}
#endif

void main() {
    CurvePoint at;
    if (!curve_point(at)) discard;
    CurveFrame c = curve_frame(at);
    Fibre f = Fibre(absorption(), u_fibre.x, u_fibre.y, u_fibre.z, u_fibre.w);
    SeenFibre s = seen_fibre(f, vec3(c.sine, 0.0, c.cosine), at.across, at.pixels);

    vec3 radiance = vec3(0.0);
#if HAS_ENVIRONMENT || HAIR_LIGHT
    vec3 around = light_about_fibre(s, c.axes, at.position);
#if MEDIA
    MediaLight media = light_around(at.position, vec3(0.0));
    around = around * media.sky + media.scattered;
#endif
    radiance += around;
#endif
#if LIGHT_COUNT > 0
    int i = 0;
    do {
        radiance += light_on_fibre(i, at, s, c.axes);
    } while (++i < LIGHT_COUNT);
#endif
    write_curve(radiance, at);
}
