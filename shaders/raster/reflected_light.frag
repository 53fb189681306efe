// Radiance at the hits of the rays of reflection_rays.frag, interpolated between the vertices of the triangle.
//
// The baked vertex radiance is that of a Lambertian surface of the same colour. For a metal we scale it by the ratio of
// the environment over its specular lobe to the environment over the hemisphere. The ratio knows no shadows, so the
// lobe is kept wide and the ratio bounded.
#include "raster/environment.glsl"
#include "sample/octahedron.glsl"
#include "sample/luminance.glsl"
#include "trace/hit.glsl"

uniform usampler2D u_hit;      // viewer/trace/rays/intersect.py
uniform sampler2D u_positions;
uniform sampler2D u_direction; // w: the ray's weight in the lobe, 0 where there is none
uniform int u_count;           // of a pixel's rays
// viewer/raster/traced/reflected_surfaces.py:
uniform isampler2D u_first_vertex;   // of each instance
uniform sampler2D u_vertex_radiance; // of each triangle's vertices; a: a component of the face normal, 0 if two-sided
uniform sampler2D u_vertex_surface;  // octahedral normal, roughness, metallic

layout(location = 0) out vec4 o_hit_radiance;
// Luminance of the environment along the ray, unoccluded and occluded; 1 where it is not occluded; 1. All are weighted
// sums over a pixel's rays.
layout(location = 1) out vec4 o_environment;

const float LEAST_ROUGHNESS = 0.35, MAX_RATIO = 4.0;

vec3 normal(vec4 surface) {
    return from_octahedron(surface.xy * 2.0 - 1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 direction = texelFetch(u_direction, pixel, 0);
    o_hit_radiance = o_environment = vec4(0.0);
    if (direction.w == 0.0) return;
    uvec4 texel = texelFetch(u_hit, pixel, 0);
    float roughness = abs(texelFetch(u_positions, pixel, 0).w);
    // The rays of 16 pixels share a lobe. Each of n stands for a part 1 / n of it: roughness by the fourth root of n.
    float part = direction.w / float(u_count);
    float sky = luminance(environment_specular(direction.xyz, 0.5 * pow(float(u_count), -0.25) * roughness));
    o_environment = part * vec4(sky, 0.0, 0.0, 1.0);
    if (hit_kind(texel) == NO_KIND) {
        o_environment.gb = part * vec2(sky, 1.0);
        return;
    }
    Hit hit = unpack_hit(texel);
    int width = textureSize(u_first_vertex, 0).x;
    int first = texelFetch(u_first_vertex, ivec2(hit.instance % width, hit.instance / width), 0).r + 3 * hit.triangle;
    width = textureSize(u_vertex_radiance, 0).x;
    vec4 radiances[3], surfaces[3];
    for (int k = 0; k < 3; ++k) {
        ivec2 at = ivec2((first + k) % width, (first + k) / width);
        radiances[k] = texelFetch(u_vertex_radiance, at, 0);
        surfaces[k] = texelFetch(u_vertex_surface, at, 0);
    }
    vec3 face = vec3(radiances[0].a, radiances[1].a, radiances[2].a);
    if (dot(direction.xyz, face) > 0.0) return; // the back of a one-sided surface is black
    vec2 uv = hit.barycentric;
    vec3 weights = vec3(1.0 - uv.x - uv.y, uv);
    vec3 radiance = mat3(radiances[0].rgb, radiances[1].rgb, radiances[2].rgb) * weights;
    vec3 n = normalize(mat3(normal(surfaces[0]), normal(surfaces[1]), normal(surfaces[2])) * weights);
    n *= dot(n, direction.xyz) > 0.0 ? -1.0 : 1.0;
    vec2 roughness_metallic = mat3x2(surfaces[0].zw, surfaces[1].zw, surfaces[2].zw) * weights;
    vec3 lobe = environment_specular(reflect(direction.xyz, n), max(roughness_metallic.x, LEAST_ROUGHNESS));
    vec3 ratio = min(lobe / max(environment_irradiance_over_pi(n), 1e-6), MAX_RATIO);
    o_hit_radiance.rgb = part * radiance * mix(vec3(1.0), ratio, roughness_metallic.y);
}
