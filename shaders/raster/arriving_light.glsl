// What is left of the light around a surface when it arrives there: media and other surfaces hide some of it, and add
// their own.
#if MEDIA
#include "raster/lit_media.glsl"
#endif
#include "raster/specular_occlusion.glsl"
#if INDIRECT
#include "raster/indirect.glsl"
#endif

#if MEDIA
// The environment's light over a specular lobe about d and over the hemisphere about n, as it arrives through media,
// with the light that they scatter. The mean direction of the cosine lobe is 2/3 n.
void light_through_media(vec3 n, vec3 d, inout mat2x3 specular, inout vec3 mean_light) {
    MediaLight mirrored = light_around(v_position, d), diffuse = light_around(v_position, n * (2.0 / 3.0));
    for (int k = 0; k < 2; ++k) specular[k] = specular[k] * mirrored.sky + mirrored.scattered;
    mean_light = mean_light * diffuse.sky + diffuse.scattered;
}
#endif

#if SKY_SHADOWS
#include "raster/past_meshes.glsl"

// What other surfaces leave of the light around, as raster/visibility.glsl has it, from what fog knows of it. The cell
// of the surface itself is full of it, so half a cell away is looked up.
vec4 visible_past_meshes(Point p, float alpha) {
    vec3 mean = p.n * (2.0 / 3.0); // of the cosine lobe
    vec3 place = v_position + 0.5 / (u_scene_grid.w * float(textureSize(u_media_light, 0).x)) * p.n_geometric;
    vec4 hidden = past_meshes(place).hidden;
    float seen = 1.0 - clamp(hidden.x + dot(hidden.yzw, mean), 0.0, 1.0);
    float visible = min(seen / max(light_around(place, mean).sky, 1e-6), 1.0);
    return vec4(vec3(visible), specular_occlusion(p.NoV, visible, alpha));
}
#endif

#if HAS_TRANSMISSION && DOUBLE_SIDED && !IS_SOLID
uniform vec3 u_light_inside; // share of the light around that arrives inside of a wall (viewer/raster/enclosed.py)
#endif

// What of the light other surfaces hide, and what they add to it. `light` is that of the parts of a lobe, `around` is
// irradiance / pi.
void meet_other_surfaces(float NoV, float alpha, float occlusion, vec4 visible, inout mat2x3 light, inout vec3 around) {
#if OCCLUSION_MAP
    around *= occlusion;
    light *= specular_occlusion(NoV, occlusion, alpha);
#endif
#if VISIBILITY || SKY_SHADOWS
    around *= visible.rgb;
    light *= visible.a;
#endif
#if HAS_TRANSMISSION && DOUBLE_SIDED && !IS_SOLID
    if (!IS_FRONT) {
        around *= u_light_inside;
        for (int k = 0; k < 2; ++k) light[k] *= u_light_inside;
    }
#endif
#if INDIRECT
    add_indirect(NoV, alpha, light, around);
#endif
}

#if SUBSURFACE && INDIRECT
in vec4 v_behind; // the mean of v_indirect on the other sides of the solid

// As meet_other_surfaces, of light that arrives on the other sides of a solid.
vec3 meet_surfaces_behind(vec3 light) {
    return (1.0 - clamp(v_behind.a, 0.0, 1.0)) * light + max(v_behind.rgb, 0.0);
}
#endif
