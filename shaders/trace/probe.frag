// For the share of photons' light that the camera sees only through smooth glass: of each path whose shadow ray to the
// camera is occluded, the ray that the camera has to see there. A path whose shadow ray is unoccluded has ended. What the
// path brings is in the throughput.
#include "trace/write_state.glsl"

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    vec3 origin = texelFetch(u_shadow_origin, texel, 0).xyz, vector = texelFetch(u_shadow_vector, texel, 0).xyz;
    if (texelFetch(u_origin, texel, 0).w == IDLE || vector == vec3(0.0)) {
        write_idle();
        return;
    }
    Path p = read_path(texel, texelFetch(u_hit, texel, 0));
    bool is_seen = p.radiance != vec3(0.0);
    p.throughput = vec3(texelFetch(u_shadow_origin, texel, 0).w, texelFetch(u_shadow_vector, texel, 0).w,
                        texelFetch(u_throughput, texel, 0).w);
    p.origin = origin + vector;
    p.direction = -normalize(vector);
    p.radiance = vec3(0.0);
    write_path(p, is_seen ? ENDED : IN_FLIGHT);
}
