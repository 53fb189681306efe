// The optical depth of volumes from the cells of a grid to four lights (viewer/raster/media_light.py). The layers of
// the grid lie above each other in the target.
#include "light/punctual.glsl"
#include "raster/volumes.glsl"

uniform int u_side;  // cells along a side of the grid
uniform vec4 u_grid; // its lowest corner in eye-relative units, and 1 / its length
uniform int u_first; // the first of the lights

out vec4 o_depth;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 cell = vec3(pixel.x, pixel.y % u_side, pixel.y / u_side);
    vec3 p = u_grid.xyz + (cell + 0.5) / (u_grid.w * float(u_side));
    o_depth = vec4(0.0);
    for (int k = 0; k < 4; ++k) {
        int i = u_first + k;
        if (i >= LIGHT_COUNT) break;
        vec3 l;
        punctual_irradiance(i, p, l);
#if VOLUME_LIGHTS > 0
        int last = DIRECTIONAL_COUNT + POINT_COUNT;
        if (i >= last - VOLUME_LIGHTS && i < last) continue; // what comes out of the volumes
#endif
        float reach = i < DIRECTIONAL_COUNT ? 1e18 : distance(u_lights[i].position.xyz, p);
        o_depth[k] = min(volumes_depth_ahead(p, l, reach, u_side), 1e4);
    }
}
