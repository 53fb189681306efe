// What the rays of reflection_rays.frag met: the light that leaves there, between the corners of the triangle.
//
// Baked is what a matte surface of that colour sends. A metal sends the same light from elsewhere: as much more as its
// own lobe sees of the environment than the hemisphere does. That is blurred and bounded, for it goes without shadows.
#include "raster/environment.glsl"
#include "raster/octahedron.glsl"
#include "sample/luminance.glsl"

uniform usampler2D u_hit;      // viewer/trace/rays/intersect.py
uniform sampler2D u_positions;
uniform sampler2D u_direction; // w: 1 where there is a ray
uniform isampler2D u_first;    // of each instance, the number of its first triangle's first corner
uniform sampler2D u_looks;     // of each corner radiance, and a component of the face normal
uniform sampler2D u_lies;      // and normal, roughness, metallic

layout(location = 0) out vec4 o_met;
layout(location = 1) out vec4 o_sent; // luminance of the environment along the ray, and what of it arrives

const uint INSTANCE_MASK = 0x0fffffffu;
const int WIDTH = 4096;
const float LEAST_ROUGHNESS = 0.35, MOST = 4.0;

ivec2 place(int i) {
    return ivec2(i % WIDTH, i / WIDTH);
}

vec3 normal(vec4 corner) {
    return from_octahedron(corner.xy * 2.0 - 1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 direction = texelFetch(u_direction, pixel, 0);
    o_met = o_sent = vec4(0.0);
    if (direction.w == 0.0) return;
    uvec4 hit = texelFetch(u_hit, pixel, 0);
    uint instance = hit.x & INSTANCE_MASK;
    float roughness = texelFetch(u_positions, pixel, 0).w;
    o_sent.r = luminance(environment_specular(direction.xyz, 0.5 * roughness)); // about a sixteenth of the lobe
    if (instance == INSTANCE_MASK) {
        o_sent.g = o_sent.r;
        return;
    }
    int first = texelFetch(u_first, place(int(instance)), 0).r + 3 * int(hit.y);
    vec4 looks[3], lies[3];
    for (int k = 0; k < 3; ++k) {
        looks[k] = texelFetch(u_looks, place(first + k), 0);
        lies[k] = texelFetch(u_lies, place(first + k), 0);
    }
    if (dot(direction.xyz, vec3(looks[0].a, looks[1].a, looks[2].a)) > 0.0) return; // the back of what has none
    vec2 uv = uintBitsToFloat(hit.zw);
    vec3 weights = vec3(1.0 - uv.x - uv.y, uv);
    vec3 radiance = mat3(looks[0].rgb, looks[1].rgb, looks[2].rgb) * weights;
    vec3 n = normalize(mat3(normal(lies[0]), normal(lies[1]), normal(lies[2])) * weights);
    n *= dot(n, direction.xyz) > 0.0 ? -1.0 : 1.0;
    vec2 roughness_metallic = mat3x2(lies[0].zw, lies[1].zw, lies[2].zw) * weights;
    vec3 lobe = environment_specular(reflect(direction.xyz, n), max(roughness_metallic.x, LEAST_ROUGHNESS));
    vec3 more = min(lobe / max(environment_irradiance_over_pi(n), 1e-6), MOST);
    o_met.rgb = radiance * mix(vec3(1.0), more, roughness_metallic.y);
}
