// What each pixel that no triangle can touch shows of the environment: the mean over a regular grid of points in the
// pixel, which is that of the box filter, and 1. Elsewhere 0.
#include "trace/environment.glsl"
#include "trace/background.glsl"
#include "trace/camera.glsl"

uniform sampler2D u_covered;
uniform int u_points; // along each axis of a pixel

out vec4 o_sky;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    bool is_empty = texelFetch(u_covered, pixel, 0).r == 0.0;
    vec3 mean = vec3(0.0);
#if BACKGROUND
    int count = is_empty ? u_points * u_points : 0;
    for (int k = 0; k < count; ++k) {
        vec2 point = (vec2(k % u_points, k / u_points) + 0.5) / float(u_points);
        vec3 o, d;
        camera_ray(vec2(view_pixel(pixel)) + point, o, d);
        mean += background_radiance(d) / float(count);
    }
#endif
    o_sky = vec4(mean, float(is_empty));
}
