// Where meshes stand before the environment, for what lies in media: on the grids of lit_media.glsl.
#if FOG
uniform vec4 u_scene_grid; // about the meshes: finer than that about the fog
#endif

// What meshes change of the light around a point. xyzw: the opacity of media and meshes before the environment, as
// a + b . direction; and what is left of the light that media scatter, where they are in the way of it
vec4 hidden_by_all(vec3 p, out float left) {
    vec3 uvw;
    int grid = 0;
#if VOLUMES > 0
    uvw = in_grid(u_volume_grid, p);
    if (is_inside(uvw)) grid = FOG;
#if FOG
    else
#endif
#endif
#if FOG
    {
        uvw = in_grid(u_scene_grid, p);
        if (is_inside(uvw)) grid = GRIDS;
        else uvw = in_grid(u_fog_grid, p);
    }
#endif
    left = part_of_cubes(u_media_light, uvw, 3 * GRIDS + 2 * grid + 1).g;
    return part_of_cubes(u_media_light, uvw, 3 * GRIDS + 2 * grid);
}
