// What camera rays see of the environment. BACKGROUND: 0 nothing, 1 the map that lights surfaces, 2 u_background by
// B-splines: that map where it is magnified, or a blurred one
#if BACKGROUND == 2
#include "trace/equirect.glsl"
#define EXACT_TEXELS 1
#include "light/bspline.glsl"

uniform samplerBuffer u_background;
uniform vec3 u_background_shape;
#endif

vec3 background_radiance(vec3 d) {
#if BACKGROUND == 2
    vec2 uv = precise_equirect_uv(to_environment(d));
    return bspline(u_background, u_background_shape, uv) * u_environment_intensity;
#else
    return environment_radiance(d);
#endif
}
