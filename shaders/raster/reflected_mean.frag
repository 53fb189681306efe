// Reflected radiance of a pixel's lobe: a joint bilateral filter over 5 x 5 pixels' rays, whose directions are spread
// over the lobe. Normals, positions and roughness of the G-buffer are the guide. The narrower the lobe, the narrower
// the filter: a mirror uses its own ray alone.
//
// The 16 directions repeat every 4 pixels. The outermost rows and columns count half, so that on a plane each direction
// has the same weight at every pixel: 1/2 + 1/2 = 1 along each axis. With equal taps a fifth of the rows would count
// twice, others at each pixel, and a grid of 4 pixels would show.
#include "sample/octahedron.glsl"

const float HIT_DISTANCE = 0.25; // assumed, in units of the scene's radius: reflected surfaces are mostly farther away

// Of the environment's light, rays see at most so much more than their number says. A single ray that leaves a fold
// towards a lamp would else stand for nearly all of it: a white speck in each pixel that has such a ray.
const float MOST = 2.0;

uniform sampler2D u_positions;
uniform sampler2D u_normals;
uniform sampler2D u_hit_radiance, u_environment; // sums over each pixel's rays: reflected_light.frag

// rgb: radiance from the model, a: part of the environment's light that it occludes
layout(location = 0) out vec4 o_reflected;
layout(location = 1) out vec4 o_place; // position; w: the shading normal, packed

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(u_hit_radiance, 0) - 1;
    vec4 here = texelFetch(u_positions, pixel, 0);
    vec2 normal = texelFetch(u_normals, pixel, 0).xy;
    vec3 n = from_octahedron(normal);
    float alpha = here.w * here.w;
    vec3 radiance = vec3(0.0);
    vec4 environment = vec4(0.0);
    for (int k = 0; k < 25; ++k) {
        ivec2 away = ivec2(k % 5, k / 5) - 2, tap = clamp(pixel + away, ivec2(0), last);
        vec4 there = texelFetch(u_positions, tap, 0);
        if (there.w == 0.0) continue;
        vec3 dn = from_octahedron(texelFetch(u_normals, tap, 0).xy) - n, dp = there.xyz - here.xyz;
        // Standard deviations: alpha for the normal, the lobe's width at HIT_DISTANCE for the position; a difference
        // of 0.1 in roughness costs a factor of e.
        float weight = exp(-0.5 * (dot(dn, dn) + dot(dp, dp) / (HIT_DISTANCE * HIT_DISTANCE)) / max(alpha * alpha, 1e-8)
                           - 10.0 * abs(abs(there.w) - abs(here.w)));
        weight *= (abs(away.x) == 2 ? 0.5 : 1.0) * (abs(away.y) == 2 ? 0.5 : 1.0);
        radiance += weight * texelFetch(u_hit_radiance, tap, 0).rgb;
        environment += weight * texelFetch(u_environment, tap, 0);
    }
    vec2 seen = environment.yz / max(environment.xw, 1e-20); // of the light, of the rays
    float part = environment.x > 0.0 ? min(seen.x, MOST * seen.y) : 1.0;
    o_reflected = vec4(radiance / max(environment.w, 1e-20), 1.0 - part);
    o_place = vec4(here.xyz, pack_octahedron(normal));
}
