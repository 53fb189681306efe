// Adds the first collisions of camera rays that meet no surface to the sums of the wavefront: the albedo of the medium,
// no normal, the distance, and in w of the emission 1 for each.
#include "trace/flight.glsl"
#include "trace/camera.glsl"
#if HAS_GRIDS
#include "media/volume_medium.glsl"
#include "trace/volume_flight.glsl"
#endif

layout(location = 0) out vec4 o_albedo; // rgb, 1
layout(location = 1) out vec4 o_normal; // 0, distance along the ray in world units
layout(location = 2) out vec4 o_emission;

void main() {
    ivec2 texel = place_of(ivec2(gl_FragCoord.xy));
    Path p = read_path(texel, uvec4(0u));
    Medium m = medium_of(innermost(p.medium));
    float way = scatters(m) ? flight_of(p, m, vertex_numbers(path_sample(texel, p.left), p, FLIGHT_GROUP).x) : 3e38;
#if HAS_GRIDS
    vec4 flight = texelFetch(u_flight, texel, 0);
    if (flight.x < way) {
        way = flight.x;
        m = volume_medium(int(flight.y));
    }
#endif
    o_albedo = vec4(m.albedo, 1.0);
    o_normal = vec4(vec3(0.0), camera_distance(p.origin + way * p.direction));
    o_emission = vec4(vec3(0.0), 1.0);
}
