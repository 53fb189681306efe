// The environment behind everything. SMOOTH: a texel covers several pixels
#include "light/equirect.glsl"
#if SMOOTH
#include "light/bspline.glsl"
#endif

#if MEDIA
#include "raster/in_media.glsl"
#endif

uniform sampler2D u_background;
uniform mat3 u_ray;          // (x, y, 1) in normalised device coordinates to a direction in the environment
#if !SMOOTH
uniform float u_lod;         // of the map that matches a pixel
#endif
uniform float u_environment_intensity;

in vec2 v_ndc;
out vec4 o_color;

void main() {
    vec3 d = normalize(u_ray * vec3(v_ndc, 1.0));
#if SMOOTH
    vec3 radiance = bspline(u_background, equirect_uv(d)) * u_environment_intensity;
#else
    vec3 radiance = textureLod(u_background, equirect_uv(d), u_lod).rgb * u_environment_intensity;
#endif
#if MEDIA
    Haze haze = haze_at(1e18);
    radiance = radiance * haze.transmittance + haze.light;
#endif
#if HALF_TARGET
    radiance = min(radiance, vec3(65504.0));
#endif
    o_color = vec4(radiance, 1.0);
}
