// What camera rays see of the environment. BACKGROUND: 0 nothing, 1 the map that lights surfaces, 2 u_background by
// B-splines: that map where it is magnified, or a blurred one
#if BACKGROUND == 2
#include "trace/equirect.glsl"
#include "light/bspline.glsl"

uniform sampler2D u_background;
#endif

vec3 background_radiance(vec3 d) {
#if BACKGROUND == 2
    return bspline(u_background, precise_equirect_uv(turn_environment(d, 1.0))) * u_environment_intensity;
#else
    return environment_radiance(d);
#endif
}
