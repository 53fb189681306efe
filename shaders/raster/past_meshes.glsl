// What meshes do to the light in media, on the grids of lit_media.glsl.
#if FOG
uniform vec4 u_scene_grid; // about the meshes: finer than that about the fog
#endif

struct PastMeshes {
    vec4 hidden;    // with SKY_SHADOWS, the opacity of media and meshes before the environment, as a + b . direction
    vec3 reflected; // radiance that meshes reflect of lamps and suns, the mean over all directions
    float left;     // of the light that media scatter, where meshes are in the way of it
};

PastMeshes past_meshes(vec3 p) {
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
    int part = 3 * GRIDS + (1 + SKY_SHADOWS) * grid;
    vec4 light = part_of_cubes(u_media_light, uvw, part);
    PastMeshes found = PastMeshes(vec4(0.0), light.rgb, light.a);
#if SKY_SHADOWS
    found.hidden = part_of_cubes(u_media_light, uvw, part + 1);
#endif
    return found;
}
