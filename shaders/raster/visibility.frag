// Visibility of the environment: shadowed over unshadowed light, 1 where there is no light; and where it was found.
#include "sample/octahedron.glsl"
uniform sampler2D u_positions;
uniform sampler2D u_normals;
uniform sampler2D u_shadowed;
uniform sampler2D u_unshadowed;
layout(location = 0) out vec4 o_visibility;
layout(location = 1) out vec4 o_place; // position; w: 0 where it is empty, else the shading normal, packed

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 shadowed = texelFetch(u_shadowed, pixel, 0), unshadowed = texelFetch(u_unshadowed, pixel, 0);
    o_visibility = mix(vec4(1.0), shadowed / max(unshadowed, 1e-30), greaterThan(unshadowed, vec4(0.0)));
    vec4 surface = texelFetch(u_positions, pixel, 0);
    o_place = vec4(surface.xyz, surface.w == 0.0 ? 0.0 : pack_octahedron(texelFetch(u_normals, pixel, 0).xy));
}
