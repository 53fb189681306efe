// Spreads the light that comes out of solids over their surfaces, by Burley's profile in screen space. Christensen &
// Burley 2015; King, Xu & others sample it so: points of a disk towards the eye, whose distances follow the profile.
//
//   R(r) = s (e^(-s r) + e^(-s r / 3)) / (8 pi r)      in the plane: density r of the distance, 2 pi r R(r)
//
// Each channel has an s of its own and gives a third of the points; each point counts for all channels, with the mean
// of the three densities (balance heuristic; Veach 1997). What lies on another instance, or nowhere, is left out, and
// the rest weighs more.
#include "bsdf/constants.glsl"

uniform sampler2D u_gathered, u_positions, u_profiles;
uniform mat4 u_view_projection;
uniform vec3 u_right, u_up, u_forward;
layout(location = 0) out vec4 o_light;

const float GOLDEN_ANGLE = 2.39996323;

// r s at the share u of the distances: 1 - e^-x / 4 - 3/4 e^(-x/3) = u. Golubev 2018, "Efficient Screen-Space
// Subsurface Scattering Using Burley's Normalized Diffusion in Real-Time"
float profile_distance(float u) {
    float v = 1.0 - u, g = 1.0 + 4.0 * v * (2.0 * v + sqrt(1.0 + 4.0 * v * v));
    float n = pow(g, -1.0 / 3.0), c = 1.0 + g * n * n + n;
    return 3.0 * log(c / (4.0 * v));
}

// 8 pi r R(r)
vec3 profile(vec3 s, float r) {
    return s * (exp(-s * r) + exp(-s * (r / 3.0)));
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec2 size = vec2(textureSize(u_positions, 0));
    vec4 here = texelFetch(u_positions, pixel, 0);
    vec3 s = texelFetch(u_profiles, pixel, 0).rgb;
    vec3 weights = vec3(1e-9), sum = weights * texelFetch(u_gathered, pixel, 0).rgb;
    for (int k = 0; k < POINTS; ++k) {
        float r = profile_distance((float(k) + 0.5) / float(POINTS)) / s[k % 3];
        float angle = GOLDEN_ANGLE * float(k);
        vec3 offset = r * (cos(angle) * u_right + sin(angle) * u_up);
        vec4 at = u_view_projection * vec4(here.xyz + offset, 1.0);
        vec2 tap = (0.5 + 0.5 * at.xy / at.w) * size;
        if (any(lessThan(tap, vec2(0.0))) || any(greaterThanEqual(tap, size))) continue;
        vec4 there = texelFetch(u_positions, ivec2(tap), 0);
        if (there.w != here.w) continue;
        float deep = dot(there.xyz - here.xyz, u_forward);
        float distance = sqrt(r * r + deep * deep);
        vec3 density = profile(s, r);
        vec3 weight = profile(s, distance) * (r / max(distance, 1e-30)) * 3.0 / (density.r + density.g + density.b);
        weights += weight;
        sum += weight * texelFetch(u_gathered, ivec2(tap), 0).rgb;
    }
    o_light = vec4(sum / weights, 1.0);
}
