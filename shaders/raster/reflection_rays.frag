// Begins one of the reflection rays at each pixel's surface, along a direction sampled from the distribution of visible
// normals, and says how much light from there weighs in the lobe. A block of 4 x 4 pixels covers the lobe with a
// Hammersley point set. The mirrored bits spread a pixel's own rays over the lobe, too. Rays are in tracer space: the
// scene's centre is the origin and its radius the unit (viewer/trace/scene/geometry.py).
#include "bsdf/visible_normal.glsl"
#include "sample/octahedron.glsl"
#include "sample/lattice.glsl"
#include "trace/shading_normal.glsl"

uniform sampler2D u_positions;
uniform sampler2D u_normals;
uniform vec3 u_eye;            // in tracer space
uniform vec3 u_view_direction; // towards the eye
uniform int u_number, u_count; // of the pixel's rays

layout(location = 0) out vec4 o_origin;    // w: 1 where there is a ray
layout(location = 1) out vec4 o_direction; // w: its weight

// Offset of the origin from the surface. A position relative to the eye has a rounding error in proportion to its
// distance from the eye, and that of the rasteriser's interpolation.
const float OFFSET = 2e-5;

// Order of the 16 pixels of a block, so that neighbours have distant numbers. Bayer 1973, "An Optimum Method for
// Two-Level Rendition of Continuous-Tone Pictures"
uint bayer(ivec2 pixel) {
    uvec2 p = uvec2(pixel) & 3u;
    uint both = p.x ^ p.y;
    return (both & 1u) << 3 | (p.y & 1u) << 2 | (both & 2u) | p.y >> 1;
}

// The part of the light along wi that arrives at the visible facets, G2 / G1 = NoL (NoV + T_o) / (NoL T_o + NoV T_i)
// (Heitz 2018, "Sampling the GGX Distribution of Visible Normals"). Rays that graze the surface meet others most often,
// and weigh least. Dielectrics have no such weight: their F grows towards the same rays, by up to 1 / f0.
float lit_part(vec3 wo, vec3 wi, vec2 alpha) {
    float t_o = smith_t(wo, alpha), t_i = smith_t(wi, alpha);
    return max(wi.z, 0.0) * (wo.z + t_o) / (wi.z * t_o + wo.z * t_i);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(u_positions, pixel, 0);
    o_origin = o_direction = vec4(0.0);
    if (abs(surface.w) >= 1.0) return; // traced_share() is 0
    vec4 normals = texelFetch(u_normals, pixel, 0);
    vec3 face = from_octahedron(normals.zw);
#if IS_ORTHOGRAPHIC
    vec3 v = u_view_direction;
#else
    vec3 v = -normalize(surface.xyz);
#endif
    vec3 n = bend_normal(from_octahedron(normals.xy), face, v);
    vec3 t = orthonormal_basis(n)[0];
    mat3 frame = mat3(t, cross(n, t), n);
    vec3 wo = v * frame;
    wo.z = max(wo.z, 1e-4);
    vec2 alpha = vec2(max(surface.w * surface.w, 1e-6));
    vec2 u = hammersley(bayer(pixel) * uint(u_count) + uint(u_number), 16u * uint(u_count));
    vec3 h = sample_visible_normal(wo, alpha, cap_bound(wo, alpha), u);
    vec3 wi = reflect(-wo, h);
    vec3 d = frame * wi;
    d -= 2.0 * min(dot(d, face), 0.0) * face; // mirror directions below the triangle back up
    o_origin = vec4(u_eye + surface.xyz + OFFSET * max(1.0, length(surface.xyz)) * face, 1.0);
    o_direction = vec4(normalize(d), surface.w < 0.0 ? lit_part(wo, wi, alpha) : 1.0);
}
