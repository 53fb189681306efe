// Where the surfaces are and how they lie, one sample a pixel, for passes that look at them from other directions.
#include "raster/material.glsl"
#include "raster/normal.glsl"
#include "raster/octahedron.glsl"
layout(location = 1) out vec4 o_normals; // shading normal in xy, the triangle's in zw

uniform float u_perceptual_roughness;

void main() {
    coverage(base_color().a);
    float perceptual_roughness = u_perceptual_roughness;
#if METALLIC_ROUGHNESS_MAP
    perceptual_roughness *= metallic_roughness_texel().g;
#endif
    vec3 n = geometric_normal();
    o_color = vec4(v_position, max(perceptual_roughness, 1e-3)); // 0: nothing is here
    // Of the triangle itself, which is what hides light behind its plane, however smoothly it is shaded
    vec3 face = cross(dFdx(v_position), dFdy(v_position));
    face *= sign(dot(face, n)) / max(length(face), 1e-30);
    o_normals = vec4(to_octahedron(shading_normal(n)), to_octahedron(face == vec3(0.0) ? n : face));
}
