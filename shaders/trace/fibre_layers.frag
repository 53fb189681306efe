// As trace/layers.frag, for camera rays that hit a curve.
#include "trace/state.glsl"
#include "trace/fibre_hit.glsl"
#include "trace/camera.glsl"

layout(location = 0) out vec4 o_albedo; // rgb, 1
layout(location = 1) out vec4 o_normal; // world axes; distance along the ray in world units
layout(location = 2) out vec4 o_emission;

void main() {
    ivec2 texel = place_of(ivec2(gl_FragCoord.xy));
    uvec4 hit = texelFetch(u_hit, texel, 0);
    Path p = read_path(texel, hit);
    FibreHit i = fibre_hit(unpack_hit(hit), p.origin, p.direction);
    vec3 wo = -p.direction * i.frame;
    vec3 albedo = fibre_albedo(i.fibre, fibre_offset(vec3(0.0, 0.0, 1.0), wo), wo);
    o_albedo = vec4(min(albedo, 1.0), 1.0);
    o_normal = vec4(i.n, camera_distance(i.position));
    o_emission = vec4(0.0);
}
