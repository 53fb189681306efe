// The environment behind everything. SMOOTH: a texel covers several pixels
#include "light/equirect.glsl"
#if SMOOTH
#include "light/bspline.glsl"
#endif

#if MEDIA
#include "raster/in_media.glsl"
#endif

#if SMOOTH
uniform usamplerBuffer u_background;
uniform vec3 u_background_shape;
#else
uniform sampler2D u_background;
uniform float u_lod;         // of the map that matches a pixel
#endif
uniform float u_environment_intensity;

noperspective in vec3 v_ray; // in the environment
out vec4 o_color;

void main() {
    vec3 d = normalize(v_ray);
#if SMOOTH
    vec3 radiance = bspline(u_background, u_background_shape, equirect_uv(d)) * u_environment_intensity;
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
