// What a pixel's lobe meets, by the rays of those about it that lie alike: their directions are spread over the lobe.
// The narrower that is, the fewer of them: a mirror has its own alone.
#include "raster/octahedron.glsl"

uniform sampler2D u_positions;
uniform sampler2D u_normals;
uniform sampler2D u_met; // of one ray: radiance, and 1 where it met anything

out vec4 o_reflected;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(u_met, 0) - 1;
    vec4 here = texelFetch(u_positions, pixel, 0);
    vec3 n = from_octahedron(texelFetch(u_normals, pixel, 0).xy);
    float alpha = here.w * here.w;
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int k = 0; k < 25; ++k) {
        ivec2 tap = clamp(pixel + ivec2(k % 5, k / 5) - 2, ivec2(0), last);
        vec4 there = texelFetch(u_positions, tap, 0);
        if (there.w == 0.0) continue;
        vec3 turned = from_octahedron(texelFetch(u_normals, tap, 0).xy) - n, moved = there.xyz - here.xyz;
        // A lobe's width of turn, a hundredth of the distance off the plane, a tenth of roughness
        float weight = exp(-0.5 * dot(turned, turned) / max(alpha * alpha, 1e-8)
                           - 100.0 * abs(dot(moved, n)) / length(here.xyz) - 10.0 * abs(there.w - here.w));
        sum += weight * texelFetch(u_met, tap, 0);
        weights += weight;
    }
    o_reflected = sum / weights;
}
