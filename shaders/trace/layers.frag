// Adds the first hits of camera rays to the sums of the wavefront: albedo, shading normal, distance and emission.
#include "bsdf/surface_of.glsl"
#include "trace/bounce.glsl"
#include "trace/camera.glsl"

layout(location = 0) out vec4 o_albedo; // rgb, 1
layout(location = 1) out vec4 o_normal; // world axes, towards the camera's side; distance along the ray in world units
layout(location = 2) out vec4 o_emission;

void main() {
    ivec2 texel = place_of(ivec2(gl_FragCoord.xy));
    uvec4 hit = texelFetch(u_hit, texel, 0);
    Path p = read_path(texel, hit);
    vec3 wo = -p.direction;
    Interaction i = interact(unpack_hit(hit), wo);
    SurfaceMaterial m = material_at(i);
    bool is_glass = hit_kind(hit) == KIND_GLASS;
    bool is_back = !i.is_front && !m.is_double_sided && !is_glass && hit_kind(hit) != KIND_TRANSLUCENT;
    // The same random number as in the pass that shades this surface
    float u = vertex_numbers(path_sample(texel, p.left), p, LIGHT_GROUP).w;
#if HAS_SEE_THROUGH
    u = number_of_coverage(p, u);
#endif
    if (continues_straight(p, m, is_back, u)) discard;

    m.emission = through_coat(m.emission, i, m.inputs, wo);
    vec3 albedo = surface_albedo(surface_of(m.inputs), dot(i.n, wo), u_dfg);
    if (m.is_unlit) albedo = m.inputs.base_color.rgb;
    if (is_glass) albedo = vec3(1.0);
    o_albedo = vec4(min(albedo + m.emission, 1.0), 1.0);
    o_normal = vec4(i.n, camera_distance(i.position));
#if HAS_SCATTERING
    int medium = innermost(p.medium);
    float way = length_in(medium, p.origin, p.direction, 0.0, distance(p.origin, i.position));
    vec3 throughput = p.throughput * transmittance(medium, way);
#else
    vec3 throughput = p.throughput * transmittance(number_of(p.medium), p.travelled + distance(p.origin, i.position));
#endif
    o_emission = vec4(throughput * (m.is_unlit ? m.inputs.base_color.rgb : m.emission), 0.0);
}
