// Follows the rays of all paths through the volumes, after intersection and before the paths are classified: where a
// path collides in a volume before its hit, and what volumes leave of the light of its shadow ray. Volumes are not in
// glass: solids with a boundary that refracts displace them.
#include "trace/numbers.glsl"
#include "media/medium.glsl"
#include "media/nesting.glsl"
#include "media/tracking.glsl"
#include "trace/endless.glsl"

layout(location = 0) out vec4 o_along;  // u_along, with volumes on the way of the shadow ray
layout(location = 1) out vec4 o_flight; // distance to the collision before the hit, else NO_COLLISION; volume

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    o_along = texelFetch(u_along, texel, 0);
    o_flight = vec4(NO_COLLISION, 0.0, 0.0, 0.0);
    float status = sign(texelFetch(u_origin, texel, 0).w);
    if (status == IDLE) return;
    Path p = read_path(texel, uvec4(0u));
    Sample s = path_sample(texel, p.left);
    extinction_scale = extinction_left(p);
    uint counter = vertex_hash(s, p, FLIGHT_GROUP);
    vec3 vector = texelFetch(u_shadow_vector, texel, 0).xyz;
    float size = length(vector);
    if (o_along.rgb != vec3(0.0) && medium_of(innermost(p.medium)).is_open)
        o_along.rgb *= volumes_transmittance(texelFetch(u_shadow_origin, texel, 0).xyz, vector / size, size, counter);
    if (status == IN_FLIGHT && medium_of(innermost(p.medium)).is_open) {
        int volume;
        float u = vertex_numbers(s, p, FLIGHT_GROUP).y, limit = p.reach >= 0.0 ? p.reach : NO_COLLISION;
        o_flight.x = volumes_collision(p.origin, p.direction, limit, u, counter, volume);
        o_flight.y = float(volume);
    }
    // A walk that went wrong spoils its sample, which is then left out of the picture and counted.
    if (tracking_faults > 0) o_along.rgb = vec3(uintBitsToFloat(0x7fc00000u));
}
