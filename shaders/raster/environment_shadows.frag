// Sums the light of many directional lights sampled from the environment, with shadows and without. The ratio of the
// two sums is the visibility (raster/visibility.frag); the light itself comes from the filtered environment. The
// specular lobe is widened (`u_least_alpha`) until it holds a few of the lights, or the ratio would be noise.
#include "bsdf/ggx.glsl"
#include "sample/octahedron.glsl"
#include "sample/luminance.glsl"

struct FarLight {
    vec4 u, v, depth; // rows of the matrix from eye-relative position to the atlas
    vec4 direction;   // to the light, in the world; w: a texel's size in scene units
    vec4 irradiance;  // of a surface facing it
    vec4 reflected;   // of a surface facing what hides it
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
        // Offset along the normal by the footprint of the shadow filter, which grows at grazing angles
        float offset = light.direction.w * (1.5 * sqrt(max(1.0 - facing * facing, 0.0)) + 0.5);
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
        vec4 reflected = vec4(light.reflected.rgb, lobe * luminance(light.reflected.rgb)) * NoL;
        o_shadowed += facing > 0.0 ? (1.0 - visible) * reflected : reflected;
#endif
    }
}
