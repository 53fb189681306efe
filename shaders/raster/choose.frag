// Chooses the surfaces of a pixel that are shaded: one where its samples show triangles that join smoothly, else two.
//
// Neighbouring triangles of a smooth surface look alike, and one of them stands for all. Which of them are alike their
// planes tell, where they meet the ray through the middle of the pixel: those of one object whose normals are less than
// acos(0.9) apart, and whose points on the ray are less than a quarter of a pixel from the other's plane. Of a pixel
// with more than two surfaces, which is rare, all other samples are shaded as the second one.
#include "raster/planes.glsl"
#include "raster/chosen.glsl"

uniform usampler2DMS u_triangle_samples; // number of the triangle; 0: none
uniform vec2 u_pixel; // size of a pixel: x + y times the distance

noperspective in vec3 v_ray, v_ray_origin; // 1 along the camera's axis; from the scene's centre
layout(location = 0) out uvec2 o_chosen; // BACKGROUND: the background counts as a surface

bool are_alike(vec4 a, vec4 b) {
    vec2 along = vec2(dot(a.xyz, v_ray), dot(b.xyz, v_ray));
    vec2 t = -vec2(dot(a.xyz, v_ray_origin) + a.w, dot(b.xyz, v_ray_origin) + b.w) / along;
    vec2 apart = abs((t.x - t.y) * along);
    return dot(a.xyz, b.xyz) > 0.9 && max(apart.x, apart.y) < 0.25 * (u_pixel.x + u_pixel.y * t.x);
}

void main() {
    const uint all = (1u << SAMPLES) - 1u;
    uint triangles[SAMPLES];
    uint first = 0u, covered = 0u, same = 0u, second = 0u;
    for (int k = 0; k < SAMPLES; ++k) {
        triangles[k] = texelFetch(u_triangle_samples, ivec2(gl_FragCoord.xy), k).r;
        first = first == 0u ? triangles[k] : first;
        covered |= triangles[k] != 0u ? 1u << k : 0u;
    }
    // One that two samples show comes first. Where sample 0 has it, or none of them, that is sample 0's; the last of four
    // samples lies beside the two others.
    uint last = triangles[SAMPLES - 1];
    for (int k = 1; k < SAMPLES - 1; ++k) first = last != 0u && triangles[k] == last ? last : first;
    for (int k = 0; k < SAMPLES; ++k) same |= triangles[k] == first ? 1u << k : 0u;
    same &= covered;
    gl_FragDepth = covered != 0u ? object_depth(first) : FAR;
    vec4 plane = plane_of(first);
    uint others = covered & ~same;
    // Each turn is for one of the other triangles. llvmpipe takes the first turn of a loop in all pixels, and with its
    // condition at the top one turn more than any of them needs.
    do {
        uint other = 0u, shown = 0u;
        for (int k = SAMPLES - 1; k >= 0; --k) other = (others & 1u << k) != 0u ? triangles[k] : other;
        for (int k = 0; k < SAMPLES; ++k) shown |= triangles[k] == other ? 1u << k : 0u;
        bool is_alike = other >> TRIANGLE_BITS == first >> TRIANGLE_BITS && are_alike(plane, plane_of(other));
        same |= is_alike ? others & shown : 0u;
        second = is_alike || second != 0u ? second : other;
        others &= ~shown;
    } while (others != 0u);
#if BACKGROUND
    covered = all;
#endif
    o_chosen = uvec2(first, second) | uvec2(same, covered & ~same) << SAMPLES_BIT;
}
