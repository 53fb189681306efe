// What the camera sees first: albedo, shading normal and distance, and what shines, added to the wave's sums.
#include "bsdf/surface_of.glsl"
#include "trace/bounce.glsl"
#include "trace/camera.glsl"

uniform sampler2D u_dfg;

layout(location = 0) out vec4 o_albedo; // rgb, 1
layout(location = 1) out vec4 o_normal; // world axes, towards the camera's side; distance along the ray in world units
layout(location = 2) out vec4 o_emission;

void main() {
    ivec2 slot = ivec2(gl_FragCoord.xy);
    uvec4 word = texelFetch(u_hit, slot, 0);
    Path p = read_path(slot, word);
    vec3 wo = -p.direction;
    Interaction i = interact(unpack_hit(word), wo);
    SurfaceMaterial m = material_at(i);
    bool is_glass = hit_kind(word) == KIND_GLASS;
    bool is_back = !i.is_front && !m.is_double_sided && !is_glass;
    // The same number as the pass that shades it will draw
    if (goes_on(p, i, m, is_back, vertex_numbers(slot_sample(slot, p.left), p, LIGHT_GROUP).w)) discard;

    vec3 albedo = surface_albedo(surface_of(m.inputs), dot(i.n, wo), u_dfg);
    if (m.is_unlit) albedo = m.inputs.base_color.rgb;
    if (is_glass) albedo = vec3(1.0);
    o_albedo = vec4(min(albedo + m.emission, 1.0), 1.0);
    o_normal = vec4(i.n, camera_distance(i.position));
    vec3 carried = p.throughput * transmittance(p.medium, p.travelled + distance(p.origin, i.position));
    o_emission = vec4(carried * (m.is_unlit ? m.inputs.base_color.rgb : m.emission), 0.0);
}
