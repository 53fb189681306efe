// Reads, at the point being shaded, a buffer that an earlier pass has filled at one point a pixel (or more, under
// supersampling). The nearest of its samples may lie on another surface, so the bilinear weights are multiplied by how
// near each sample lies to the point's tangent plane, and where samples have normals, by how near these are to the
// point's. Kopf et al. 2007, "Joint Bilateral Upsampling"
#include "sample/octahedron.glsl"
#include "raster/varying.glsl"
uniform vec2 u_drawn_size; // of the picture, in shaded points

// `sample_position` has w = 0 where the G-buffer is empty. `footprint`: length of a pixel on the surface.
float plane_weight(vec4 sample_position, vec3 position, vec3 n, float footprint) {
    float distance_to_plane = dot(sample_position.xyz - position, n) / footprint;
    return sample_position.w == 0.0 ? 0.0 : 1.0 / (1.0 + 100.0 * distance_to_plane * distance_to_plane);
}

// 1/2 for normals 3 degrees apart. Samples without a normal in w have 1.
float normal_weight(vec4 sample_position, vec3 normal) {
    vec3 difference = normal - from_octahedron(unpack_octahedron(sample_position.w));
    return sample_position.w < PACKED ? 1.0 : 1.0 / (1.0 + 300.0 * dot(difference, difference));
}

// `n`: of the tangent plane. `normal`: that the samples' own are compared with; vec3(0.0): they are not. `fallback` is
// returned where every neighbour is empty.
vec4 joint_bilateral_fetch(sampler2D values, sampler2D positions, vec3 position, vec3 n, vec3 normal, vec4 fallback) {
    vec2 scale = vec2(textureSize(values, 0)) / u_drawn_size, at = gl_FragCoord.xy * scale;
    ivec2 pixel = ivec2(at), last = textureSize(values, 0) - 1;
    vec2 off = at - vec2(pixel) - 0.5;
    ivec2 side = ivec2(off.x < 0.0 ? -1 : 1, off.y < 0.0 ? -1 : 1);
#if DEFERRED
    float footprint = deferred_footprint / scale.x;
#else
    float footprint = (length(dFdx(position)) + length(dFdy(position))) / scale.x;
#endif
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    // First the four nearest samples, bilinearly. If most of their weight is lost (they lie on other surfaces), we add
    // the eight neighbours of the pixel.
    for (int k = 0; k < 12 && (k < 4 || weights < 0.5); ++k) {
        ivec2 corner = ivec2(k & 1, k >> 1);
        vec2 near = k < 4 ? mix(1.0 - abs(off), abs(off), vec2(corner)) : vec2(1.0);
        if (near.x * near.y == 0.0) continue;
        ivec2 away = k < 4 ? corner * side : ivec2((k + 1) % 3, (k + 1) / 3 % 3) - 1;
        ivec2 tap = clamp(pixel + away, ivec2(0), last);
        vec4 sample_position = texelFetch(positions, tap, 0);
        float weight = near.x * near.y * plane_weight(sample_position, position, n, footprint);
        if (normal != vec3(0.0)) weight *= normal_weight(sample_position, normal);
        sum += weight * texelFetch(values, tap, 0);
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : fallback;
}
