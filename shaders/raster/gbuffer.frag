// The G-buffer: position, roughness and normals of the visible surfaces, one sample a pixel, for the passes that find
// visibility and reflections before the surfaces are shaded.
#include "raster/material.glsl"
#include "raster/normal.glsl"
#include "sample/octahedron.glsl"
layout(location = 1) out vec4 o_normals; // shading normal in xy, the triangle's in zw

void main() {
    MaterialInputs m = read_inputs();
    float covered = coverage(m.base_color.a);
    vec3 n = geometric_normal();
    // w = 0 marks an empty pixel, w < 0 a metal.
    o_color = vec4(v_position, max(m.perceptual_roughness, 1e-3) * (m.metallic < 0.5 ? 1.0 : -1.0));
    // The face normal: a triangle occludes light behind its own plane, whatever its shading normal.
    vec3 face = cross(dFdx(v_position), dFdy(v_position));
    face *= sign(dot(face, n)) / max(length(face), 1e-30);
    o_normals = vec4(to_octahedron(shading_normal(n)), to_octahedron(face == vec3(0.0) ? n : face));
    drop_uncovered(covered);
}
