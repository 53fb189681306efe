// What a pixel's lobe meets, by the rays of those about it that lie alike: their directions are spread over the lobe.
// The narrower that is, the fewer of them: a mirror has its own alone.
#include "raster/octahedron.glsl"

const float NEAR = 0.25; // in units of the scene's radius: what is mirrored is mostly farther away

uniform sampler2D u_positions;
uniform sampler2D u_normals;
uniform sampler2D u_met, u_sent; // of one ray each: reflected_light.frag

out vec4 o_reflected; // radiance from the model, and which part of the environment's light the model hides

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(u_met, 0) - 1;
    vec4 here = texelFetch(u_positions, pixel, 0);
    vec3 n = from_octahedron(texelFetch(u_normals, pixel, 0).xy);
    float alpha = here.w * here.w;
    vec3 met = vec3(0.0), sent = vec3(0.0);
    for (int k = 0; k < 25; ++k) {
        ivec2 tap = clamp(pixel + ivec2(k % 5, k / 5) - 2, ivec2(0), last);
        vec4 there = texelFetch(u_positions, tap, 0);
        if (there.w == 0.0) continue;
        vec3 turned = from_octahedron(texelFetch(u_normals, tap, 0).xy) - n, moved = there.xyz - here.xyz;
        // A lobe's width of turn, and of place where it is as wide as `NEAR` away; a tenth of roughness
        float weight = exp(-0.5 * (dot(turned, turned) + dot(moved, moved) / (NEAR * NEAR)) / max(alpha * alpha, 1e-8)
                           - 10.0 * abs(there.w - here.w));
        met += weight * texelFetch(u_met, tap, 0).rgb;
        sent += weight * vec3(texelFetch(u_sent, tap, 0).rg, 1.0);
    }
    o_reflected = vec4(met / sent.z, sent.x > 0.0 ? 1.0 - sent.y / sent.x : 0.0);
}
