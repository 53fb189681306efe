// The light around a solid that scatters it inside, of which raster/from_all_around.glsl says what its sides show.
#if HAS_ENVIRONMENT
uniform vec3 u_environment_mean; // radiance
#endif

// The mean light on all sides of a solid: that of the environment, half of which meets the surfaces on the point's
// side, and half those behind.
vec3 light_all_around(Point p, float occlusion, vec4 visible) {
    vec3 around = vec3(0.0);
#if HAS_ENVIRONMENT
    around = u_environment_mean;
#endif
    mat2x3 specular = mat2x3(0.0);
#if MEDIA
    light_through_media(vec3(0.0), vec3(0.0), specular, around);
#endif
    vec3 behind = around;
    meet_other_surfaces(p.NoV, 1.0, occlusion, visible, specular, around);
#if INDIRECT
    behind = meet_surfaces_behind(behind);
#endif
    return 0.5 * (around + behind);
}
