// Sums the light of many directional lights sampled from the environment, with shadows and without. The ratio of the
// two sums is the visibility (raster/visibility.frag); the light itself comes from the filtered environment. The
// specular lobe is widened (`u_least_alpha`) until it holds a few of the lights, or the ratio would be noise.
#include "bsdf/ggx.glsl"
#include "sample/octahedron.glsl"
#include "sample/luminance.glsl"

struct FarLight {
    vec4 u, v, depth; // rows of the matrix from eye-relative position to the atlas
    vec4 direction;   // to the light, in the world; w: a texel's size in scene units
    vec4 irradiance;  // of a surface facing it; w: its solid angle
    vec4 reflected;   // of a surface facing what hides it, if nothing hides what lights that
};
layout(std140) uniform FarLights {
    FarLight u_far_lights[LIGHTS];
};
uniform sampler2D u_positions;
uniform sampler2D u_normals;
uniform sampler2DShadow u_atlas;
#if TINTED
uniform sampler2D u_tints; // raster/sky_tint.frag, in tiles at the same places
#endif
uniform float u_least_alpha; // of the specular lobe
#if ESTIMATED
uniform vec3 u_reflectance, u_emission; // the means of all surfaces
uniform float u_body; // the radius of a disc as large as a side of the mean body
#endif
uniform vec3 u_view_direction; // towards the eye

layout(location = 0) out vec4 o_shadowed; // rgb: irradiance, a: luminance reflected by the specular lobe
layout(location = 1) out vec4 o_unshadowed;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 surface = texelFetch(u_positions, pixel, 0);
    if (surface.w == 0.0) discard;
    vec4 normals = texelFetch(u_normals, pixel, 0);
    vec3 n = from_octahedron(normals.xy), n_geometric = from_octahedron(normals.zw);
#if IS_ORTHOGRAPHIC
    vec3 v = u_view_direction;
#else
    vec3 v = -normalize(surface.xyz);
#endif
    float NoV = clamp(dot(n, v), 1e-3, 1.0);
    float alpha = max(surface.w * surface.w, u_least_alpha);

    o_shadowed = o_unshadowed = vec4(0.0);
#if ESTIMATED
    vec4 reflected = vec4(0.0);
    // Solid angles by the cosine: of all lights, of the hidden ones, of these by the lobe, and of the body before these
    vec4 angles = vec4(0.0);
#endif
    for (int i = 0; i < LIGHTS; ++i) {
        FarLight light = u_far_lights[i];
        vec3 l = light.direction.xyz;
        float NoL = dot(n, l);
        if (NoL <= 0.0) continue;
        vec3 h = normalize(v + l);
        vec3 nxh = cross(n, h);
        float lobe = d_ggx(dot(n, h), dot(nxh, nxh), alpha) * v_smith_ggx(NoV, NoL, alpha);
        vec4 unshadowed = vec4(light.irradiance.rgb, lobe * luminance(light.irradiance.rgb)) * NoL;

        float facing = dot(n_geometric, l);
        // The filter reaches a texel of w along both axes, where a plane at an angle t is nearer to the light by up to
        // sqrt(2) w tan(t). The offset of the maps is at least half of that (viewer/raster/shadows.py), and d along the
        // normal is d / cos(t): the rest takes w sin(t) / sqrt(2), and a little for rounding.
        float offset = light.direction.w * (0.71 * sqrt(max(1.0 - facing * facing, 0.0)) + 0.05);
        vec4 p = vec4(surface.xyz + offset * n_geometric, 1.0);
        vec3 place = vec3(dot(light.u, p), dot(light.v, p), dot(light.depth, p));
        float visible = textureLod(u_atlas, place, 0.0);
        o_unshadowed += unshadowed;
#if TINTED
        vec4 glass = textureLod(u_tints, place.xy, 0.0);
        vec3 tint = place.z > glass.a ? exp(-max(glass.rgb, 0.0)) : vec3(1.0);
        unshadowed *= vec4(tint, luminance(tint));
#endif
        o_shadowed += facing > 0.0 ? visible * unshadowed : vec4(0.0);
#if ESTIMATED
        float hidden = facing > 0.0 ? 1.0 - visible : 1.0, near = 0.0;
        if (facing > 0.0 && hidden > 0.0) {
            float beyond = dot(light.depth, vec4(p.xyz + u_body * l, 1.0));
            near = max(textureLod(u_atlas, vec3(place.xy, beyond), 0.0) - visible, 0.0);
        }
        reflected += hidden * NoL * vec4(light.reflected.rgb, lobe * luminance(light.reflected.rgb));
        angles += NoL * light.irradiance.w * vec4(1.0, hidden, lobe * hidden, 0.5 * (1.0 + NoL) * near);
#endif
    }
#if ESTIMATED
    // What hides light from here is lit by the part 1 - f of the half of the sky that it faces, and by this surface.
    // Of that half, as much is hidden as here (Jimenez et al. 2016, "Practical Real-Time Strategies for Accurate
    // Indirect Occlusion"), or what an endless plane hides that leans like this body, if it is less far than
    // the body is wide: then a disc of this width hides more than half of what the plane does. Of n hidden lights, the
    // next could be seen, so no share is more than n / (n + 1). With reflectance r, and the share h of hidden lights,
    // light here is (direct + emitted + (1 - f) reflected) / (1 - r^2 f h). In a white furnace it is that of the sky.
    const float n_lights = 0.5 * float(LIGHTS);
    float h = angles.y / max(angles.x, 1e-30);
    float f = max(h, angles.w / max(angles.y, 1e-30)) * n_lights / (n_lights + 1.0);
    vec3 twice = f * u_reflectance * u_reflectance;
    vec4 emitted = vec4(u_emission * angles.y, luminance(u_emission) * angles.z);
    o_shadowed += (1.0 - f) * reflected + emitted;
    o_shadowed.rgb /= 1.0 - twice * h;
    o_shadowed.a += luminance(twice * o_shadowed.rgb) * angles.z / max(angles.x, 1e-30);
    // Reflected light may make a surface brighter than the bare sky does: one that faces a dark part of it, before a
    // body that faces a bright one. Where that body hides only few of the lights, it would show their outlines, since
    // each light stands for a wide part of a dark sky. So light rises with the square of h at first.
    vec4 most = o_unshadowed / max(1.0 - h * h, 1e-4) + emitted;
    o_shadowed = min(o_shadowed, min(most, 1e4 * o_unshadowed)); // half floats hold the ratio
#endif
}
