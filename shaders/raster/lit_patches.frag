// Patches of meshes that lights with shadow maps light, one for each of the squares into which a tile of the atlas is
// divided (viewer/raster/lit_patches.py): reflective shadow maps (Dachsbacher and Stamminger 2005), of which light in
// media needs a few points alone. A row of the target has the patches of a tile.
#include "bsdf/constants.glsl"
#include "raster/light_in_media.glsl"
#include "raster/lit_surface.glsl"

uniform int u_side; // patches along a side of a tile

layout(location = 0) out vec4 o_place;  // in the middle; w: area / pi
layout(location = 1) out vec4 o_normal; // towards the light; w: its number, also where it lights nothing
layout(location = 2) out vec4 o_power;  // rgb: that arrives, in lumens where lights have candela and lux

const float MARGIN = 2.0; // texels of a tile that lie beyond the scene, or beyond the face of a cube

void main() {
    int layer = int(gl_FragCoord.y), square = int(gl_FragCoord.x), i = 0, k = 0;
    do {
        int first = int(u_lights[k].direction.w);
        if (first >= 0 && first <= layer) i = k;
    } while (++k < LIGHT_COUNT);
    Tile tile = tile_of(layer);
    float side = (u_shadow_tile_size - 2.0 * MARGIN) / float(u_side);
    vec2 texel = floor(MARGIN + side * (vec2(square % u_side, square / u_side) + 0.5)) + 0.5;
    LitSurface s = lit_surface(tile, texel, i);
    o_place = o_power = vec4(0.0);
    o_normal = vec4(s.normal, float(i));
    if (s.normal == vec3(0.0)) return;

    vec3 l;
    vec3 irradiance = punctual_irradiance(i, s.place, l);
    float depth = depth_at(tile, texel);
    vec3 across = place_at(tile, texel + vec2(side, 0.0), depth) - s.place;
    vec3 up = place_at(tile, texel + vec2(0.0, side), depth) - s.place;
    float beam = abs(dot(cross(across, up), l)); // area of the square's beam
    o_place = vec4(s.place, beam / max(dot(s.normal, l), 0.05) * INV_PI);
    o_power = vec4(irradiance * beam * transmittance_to_light(i, s.place, l), 0.0);
}
