// Light that arrives at the cells of a coarse grid without having been scattered (viewer/raster/media_light.py). The
// layers of the grid lie above each other in the targets.
#include "raster/media_depth.glsl"
#if DENSE
#include "raster/dense_light.glsl"
#endif

uniform vec4 u_sky_directions[SKY_LIGHTS]; // w: the share of the environment's light
uniform vec4 u_sky_irradiance[SKY_LIGHTS]; // w: the share of the sphere
// For fits with these weights: inverse of the matrix of second moments of (1, direction)
uniform mat4 u_light_fit, u_sphere_fit;

#if SKY_SHADOWS
// Depth maps in these directions, each a tile of an atlas: rows of the matrix from eye-relative position to [0, 1]
// over the tile. What is beside a tile is beside all meshes.
uniform sampler2D u_sky_atlas;
uniform vec4 u_sky_shadows[3 * SKY_LIGHTS];
uniform ivec2 u_sky_tiles; // columns, rows
// What meshes in the way of a direction send instead; w: its luminance as a share of the environment's light
uniform vec4 u_sky_reflected[SKY_LIGHTS];

const int TAPS = 4; // points of a cell: the corners of a tetrahedron

// x: the share of a cell in which no mesh stands before the sky in direction k; y: the mean distance of those that do,
// up to their far side
vec2 seen_past_meshes(int k, vec3 p, float side) {
    float hidden = 0.0, distance = 0.0;
    vec4 u = u_sky_shadows[3 * k], v = u_sky_shadows[3 * k + 1], depth = u_sky_shadows[3 * k + 2];
    for (int tap = 0; tap < TAPS; ++tap) {
        vec3 corner = vec3(tap & 1, tap >> 1, (tap ^ tap >> 1) & 1) - 0.5;
        vec4 at = vec4(p + 0.5 * side * corner, 1.0);
        vec2 uv = vec2(dot(u, at), dot(v, at));
        if (uv != clamp(uv, 0.0, 1.0)) continue;
        vec2 place = (vec2(k % u_sky_tiles.x, k / u_sky_tiles.x) + uv) / vec2(u_sky_tiles);
        float behind = dot(depth, at) - textureLod(u_sky_atlas, place, 0.0).r;
        if (behind <= 0.0) continue;
        hidden += 1.0;
        distance += behind / length(depth.xyz);
    }
    return vec2(1.0 - hidden / float(TAPS), distance / max(hidden, 1.0));
}
#endif

uniform int u_side; // cells along a side of the grid
uniform vec4 u_grid; // its lowest corner in eye-relative units, and 1 / its length
#if LIGHT_COUNT > 0
uniform int u_light_count; // of those that light its medium
#endif

layout(location = 0) out vec4 o_fluence; // rgb; a: of light that has the fluence 1 outside, the same from everywhere
// The opacity of the media as a + b . direction, by least squares: before the light of the environment, and all around
layout(location = 1) out vec4 o_hidden;
layout(location = 2) out vec4 o_opacity;
layout(location = 3) out vec4 o_extinction; // r; a: with meshes, what they leave of the opacity of o_opacity
layout(location = 4) out vec4 o_flux[3]; // of the light of o_fluence, along each axis
#if SKY_SHADOWS
layout(location = 7) out vec4 o_hidden_by_all; // as o_hidden, by media and meshes
#endif

const int STEPS = 16; // in each volume

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 cell = vec3(pixel.x, pixel.y % u_side, pixel.y / u_side);
    vec3 p = u_grid.xyz + (cell + 0.5) / (u_grid.w * float(u_side));

    float extinction = extinction_at(p), depth_of_cell = extinction / (u_grid.w * float(u_side));
    vec4 fluence = vec4(0.0);
    for (int axis = 0; axis < 3; ++axis) o_flux[axis] = vec4(0.0);
    vec4 of_light = vec4(0.0), of_sphere = vec4(0.0);
#if SKY_SHADOWS
    vec4 past_meshes = vec4(0.0), past_white_meshes = vec4(0.0), sphere_past_meshes = vec4(0.0);
#endif
    for (int k = 0; k < SKY_LIGHTS; ++k) {
        vec3 d = u_sky_directions[k].xyz;
        float depth = media_depth(p, d, 1e18, STEPS);
        float arriving = mean_transmittance(depth, depth_of_cell);
        vec4 light = u_sky_irradiance[k] * arriving;
        vec4 hidden = one_minus_exp(depth) * vec4(1.0, d);
        of_light += u_sky_directions[k].w * hidden;
#if SKY_SHADOWS
        // A white mesh sends as much as it gets, so that a white furnace stays white.
        vec2 seen = seen_past_meshes(k, p, 1.0 / (u_grid.w * float(u_side)));
        float to_mesh = media_depth(p, d, seen.y, STEPS), share = u_sky_directions[k].w;
        light = mix(vec4(u_sky_reflected[k].rgb, u_sky_irradiance[k].w) * mean_transmittance(to_mesh, depth_of_cell),
                    light, seen.x);
        vec4 hidden_to_mesh = mix(one_minus_exp(to_mesh) * vec4(1.0, d), hidden, seen.x);
        past_meshes += (share - mix(u_sky_reflected[k].w * exp(-to_mesh), share * exp(-depth), seen.x)) * vec4(1.0, d);
        past_white_meshes += share * hidden_to_mesh;
        sphere_past_meshes += u_sky_irradiance[k].w * hidden_to_mesh;
#endif
        fluence += light;
        for (int axis = 0; axis < 3; ++axis) o_flux[axis] -= light * d[axis];
        of_sphere += u_sky_irradiance[k].w * hidden;
    }
    o_hidden = u_light_fit * of_light;
    o_opacity = u_sphere_fit * of_sphere;
#if SKY_SHADOWS
    // Scattered light keeps the directions that media alone give it (lit_media.glsl), so white meshes add none.
    float left = ((u_sphere_fit * sphere_past_meshes).x + 1e-30) / (o_opacity.x + 1e-30);
    o_hidden_by_all = u_light_fit * past_meshes;
    o_hidden_by_all.yzw += left * o_hidden.yzw - (u_light_fit * past_white_meshes).yzw;
#endif
#if LIGHT_COUNT > 0
    float nearest = 0.5 / (u_grid.w * float(u_side)); // a cell's mean of 1 / d^2 about a light is finite
    for (int k = 0; k < u_light_count; ++k) {
        int i = light_in_media(k);
        vec3 l;
        vec3 irradiance = punctual_irradiance(i, p, l);
        if (i >= DIRECTIONAL_COUNT) {
            vec3 d = u_lights[i].position.xyz - p;
            irradiance *= min(max(dot(d, d), u_lights[i].cone.z) / (nearest * nearest), 1.0);
        }
        float depth = media_depth(p, l, i < DIRECTIONAL_COUNT ? 1e18 : distance(u_lights[i].position.xyz, p), STEPS);
        irradiance *= mean_transmittance(depth, depth_of_cell) * unshadowed_by_meshes(i, p);
#if DENSE
        irradiance *= 1.0 - beyond_grid(depth_of_cell); // in_scattered.glsl has it
#endif
        fluence.rgb += irradiance;
        for (int axis = 0; axis < 3; ++axis) o_flux[axis].rgb -= irradiance * l[axis];
    }
#endif
    o_fluence = fluence;
    o_extinction = vec4(extinction);
#if SKY_SHADOWS
    o_extinction.a = left;
#endif
}
