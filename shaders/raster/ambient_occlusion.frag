// Sky visibility of a pixel's surface, from the depths in the picture: ground-truth ambient occlusion, Jimenez et al.
// 2016, "Practical Realtime Strategies for Accurate Indirect Occlusion" (GTAO). In each of SLICES planes through the
// line of sight we search the horizon on either side and integrate the cosine between the two exactly.
#include "bsdf/constants.glsl"
#include "sample/octahedron.glsl"
#include "raster/specular_occlusion.glsl"
const int SLICES = 6, STEPS = 16;
const float HALF_PI = 0.5 * PI;

uniform sampler2D u_positions;
uniform sampler2D u_normals;
uniform vec3 u_right, u_up;    // of the picture, in the world
uniform vec3 u_view_direction; // towards the eye
uniform float u_pixels;        // height of a scene unit in pixels, at distance 1 (orthographic: at any distance)
uniform float u_narrowness;    // height of a pixel over its width
out vec4 o_visibility;

// Sine of the angle above the face up to which a sample hides nothing. It is the centre of a pixel, beside the line
// that is searched: without this, a sloping plane would hide itself. Occluders so low hide 0.01 % of the light.
const float FLAT = 0.01;

// Cosine between v and the highest sample along `along`, seen from p. A sample's weight falls to 0 at the scene's
// radius: the picture tells nothing about the thickness of an occluder, and a distant one is rarely as deep as the gap
// behind it.
float horizon(vec3 p, vec3 v, vec3 n_geometric, vec2 along, float reach, float lowest) {
    float highest = lowest;
    int k = 1;
    do {
        float t = float(k) / float(STEPS);
        vec2 offset = along * max(t * t * reach, float(k));
        ivec2 tap = ivec2(floor(gl_FragCoord.xy + vec2(offset.x * u_narrowness, offset.y)));
        ivec2 inside = clamp(tap, ivec2(0), textureSize(u_positions, 0) - 1);
        vec4 occluder = texelFetch(u_positions, inside, 0);
        vec3 d = occluder.xyz - p;
        float distance = length(d);
        bool hides = occluder.w != 0.0 && tap == inside && dot(d, n_geometric) > FLAT * distance;
        float weight = hides ? clamp(2.0 - 2.0 * distance, 0.0, 1.0) : 0.0;
        highest = max(highest, mix(lowest, dot(d, v) / max(distance, 1e-6), weight));
    } while (++k <= STEPS);
    return min(highest, 1.0); // acos is undefined beyond
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(u_positions, pixel, 0);
    vec4 normals = texelFetch(u_normals, pixel, 0);
    vec3 p = surface.xyz, n = from_octahedron(normals.xy), n_geometric = from_octahedron(normals.zw);
#if IS_ORTHOGRAPHIC
    vec3 v = u_view_direction;
    float reach = u_pixels;
#else
    vec3 v = -normalize(p);
    float reach = u_pixels / max(dot(-p, u_view_direction), 1e-6);
#endif
    float sum = 0.0, whole = 0.0; // what the two horizons leave, and the whole hemisphere by the same planes
    int k = 0;
    do {
        float phi = PI * (float(k) + 0.5) / float(SLICES);
        vec2 along = vec2(cos(phi), sin(phi));
        vec3 t = along.x * u_right + along.y * u_up;
        t = normalize(t - dot(t, v) * v);
        vec3 axis = cross(t, v);
        vec3 projected = n - dot(n, axis) * axis;
        float weight = max(length(projected), 1e-6);
        float gamma = acos(clamp(dot(projected, v) / weight, -1.0, 1.0)) * (dot(projected, t) < 0.0 ? -1.0 : 1.0);
        float left = -acos(horizon(p, v, n_geometric, -along, reach, cos(gamma - HALF_PI)));
        float right = acos(horizon(p, v, n_geometric, along, reach, cos(gamma + HALF_PI)));
        left = max(left, gamma - HALF_PI);
        right = min(right, gamma + HALF_PI);
        sum += weight * 0.25 * (2.0 * cos(gamma) - cos(2.0 * left - gamma) - cos(2.0 * right - gamma)
                                + 2.0 * (left + right) * sin(gamma));
        whole += weight * (cos(gamma) + gamma * sin(gamma));
    } while (++k < SLICES);
    float sky_visibility = clamp(sum / max(whole, 1e-6), 0.0, 1.0);
    float NoV = clamp(dot(n, v), 0.0, 1.0);
    o_visibility = vec4(vec3(sky_visibility), specular_occlusion(NoV, sky_visibility, surface.w * surface.w));
}
