// One point for each path of trace/probe.frag, all at one pixel.
#include "sample/luminance.glsl"
#include "trace/is_finite.glsl"
#include "trace/material.glsl"
#include "trace/state.glsl"

flat out vec2 v_light; // that the camera sees, that smooth glass is before; luminance

const float SMOOTH = 1e-3; // as DELTA_ALPHA of bsdf/bsdf.glsl

bool is_behind_glass(ivec2 texel) {
    uvec4 hit = texelFetch(u_hit, texel, 0);
    if (hit_kind(hit) != KIND_GLASS) return false;
    SurfaceMaterial m = material_at(interact(unpack_hit(hit), -texelFetch(u_direction, texel, 0).xyz));
    return !m.is_pane && m.inputs.perceptual_roughness * m.inputs.perceptual_roughness < SMOOTH;
}

void main() {
    int columns = textureSize(u_origin, 0).x;
    ivec2 texel = ivec2(gl_VertexID % columns, gl_VertexID / columns);
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    v_light = vec2(0.0);
    float status = texelFetch(u_origin, texel, 0).w, light = luminance(texelFetch(u_throughput, texel, 0).rgb);
    if (status == IDLE || !is_finite(vec3(light))) return;
    v_light = status == ENDED ? vec2(light, 0.0) : is_behind_glass(texel) ? vec2(0.0, light) : vec2(0.0);
    if (v_light != vec2(0.0)) gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
