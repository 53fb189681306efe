// Where the surfaces are and how they lie, one sample a pixel, for passes that look at them from other directions.
#include "raster/material.glsl"
#include "raster/normal.glsl"
#include "raster/octahedron.glsl"
layout(location = 1) out vec4 o_normals; // shading normal in xy, the triangle's in zw

void main() {
    MaterialInputs m = read_inputs();
    coverage(m.base_color.a);
    vec3 n = geometric_normal();
    o_color = vec4(v_position, max(m.perceptual_roughness, 1e-3)); // 0: nothing is here
    // Of the triangle itself, which is what hides light behind its plane, however smoothly it is shaded
    vec3 face = cross(dFdx(v_position), dFdy(v_position));
    face *= sign(dot(face, n)) / max(length(face), 1e-30);
    o_normals = vec4(to_octahedron(shading_normal(n)), to_octahedron(face == vec3(0.0) ? n : face));
}
