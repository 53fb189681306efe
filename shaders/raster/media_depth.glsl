// What media keep of light on its way to a cell of a grid about them (viewer/raster/media_light.py).
#include "media/one_minus_exp.glsl"
#include "raster/light_in_media.glsl"
#if VOLUMES > 0
#include "raster/volumes.glsl"
#endif

// The optical depth from p to the distance `reach` along d, by `steps` steps in each volume
float media_depth(vec3 p, vec3 d, float reach, int steps) {
    float depth = 0.0;
#if FOG
    depth += fog_depth_ahead(p, d, reach);
#endif
#if VOLUMES > 0
    depth += volumes_depth_ahead(p, d, reach, steps);
#endif
    return depth;
}

float extinction_at(vec3 p) {
    float extinction = 0.0;
#if FOG
    extinction += fog_at(p);
#endif
#if VOLUMES > 0
    extinction += volumes_at(p);
#endif
    return extinction;
}

// The mean transmittance over a cell of optical depth `cell`, from the depth at its middle: what a cell collects is
// right also where it hides its own middle.
float mean_transmittance(float depth, float cell) {
    return exp(-max(depth - 0.5 * cell, 0.0)) * (cell > 1e-4 ? one_minus_exp(cell) / cell : 1.0);
}
