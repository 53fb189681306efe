// One point for each photon on its way, all at one pixel: what it brings to a ball about the eye, by whether its last
// vertex is rough, and so is in the picture, or of a delta lobe, as glass or a mirror, and so is not. Only what the
// picture shows of such vertices counts; what media take on the way does not.
#include "sample/luminance.glsl"
#include "trace/material.glsl"
#include "trace/state.glsl"
#include "media/medium.glsl"
#include "trace/connect.glsl"
#include "trace/is_finite.glsl"

uniform vec4 u_eye_ball; // centre, radius

flat out vec2 v_light; // luminance by rough vertices, by others

bool meets_eye(Path p, uvec4 hit) {
    vec3 to_eye = u_eye_ball.xyz - p.origin;
    float along = dot(to_eye, p.direction);
    if (along <= 0.0 || length(to_eye - along * p.direction) > u_eye_ball.w) return false;
    if (hit_kind(hit) == NO_KIND) return true;
    return hit_kind(hit) != KIND_FIBRE
        && distance(interact(unpack_hit(hit), -p.direction).position, p.origin) > along;
}

void main() {
    int columns = textureSize(u_origin, 0).x;
    ivec2 texel = ivec2(gl_VertexID % columns, gl_VertexID / columns);
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    v_light = vec2(0.0);
    if (sign(texelFetch(u_origin, texel, 0).w) != float(IN_FLIGHT)) return;
    uvec4 hit = texelFetch(u_hit, texel, 0);
    Path p = read_path(texel, hit);
    ivec2 pixel;
    vec3 seen = camera_pixel(p.origin);
    if (p.depth == 0 || p.pdf == 0.0 || seen.z <= 0.0 || !is_traced(seen.xy, pixel) || !meets_eye(p, hit)) return;
    float light = luminance(p.throughput);
    if (!is_finite(vec3(light))) return;
    v_light = p.pdf == FROM_DELTA ? vec2(0.0, light) : vec2(light, 0.0);
    gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
