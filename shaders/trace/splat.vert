// Draws a point for each path whose shadow ray to the camera is unoccluded, at its pixel. All others are clipped.
#include "trace/state.glsl"
#include "media/medium.glsl"
#include "trace/connect.glsl"
#include "trace/is_finite.glsl"

flat out vec4 v_contribution; // rgb; 1 if it is not finite, and so left out

void main() {
    int columns = textureSize(u_origin, 0).x;
    ivec2 texel = ivec2(gl_VertexID % columns, gl_VertexID / columns);
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    v_contribution = vec4(0.0);
    if (texelFetch(u_origin, texel, 0).w == IDLE || texelFetch(u_shadow_vector, texel, 0).xyz == vec3(0.0)) return;
    Path p = read_path(texel, texelFetch(u_hit, texel, 0));
    if (p.radiance == vec3(0.0)) return;
    v_contribution = is_finite(p.radiance) ? vec4(p.radiance, 0.0) : vec4(0.0, 0.0, 0.0, 1.0);
    ivec2 pixel;
    if (is_traced(camera_pixel(texelFetch(u_shadow_origin, texel, 0).xyz).xy, pixel))
        gl_Position = vec4((vec2(pixel) + 0.5) / vec2(u_camera_size) * 2.0 - 1.0, 0.0, 1.0);
}
