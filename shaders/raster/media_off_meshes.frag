// Light of lamps and suns that comes to the cells of a coarse grid off meshes, which take it for diffuse, without having
// been scattered in a medium (viewer/raster/media_light.py). The layers of the grid lie above each other in the targets.
#include "bsdf/constants.glsl"
#include "raster/media_depth.glsl"
#include "raster/lit_surface.glsl"

uniform sampler2D u_patches; // what lit_patches.frag has found, in three rows
uniform vec3 u_reflectance;
uniform int u_side;  // cells along a side of the grid
uniform vec4 u_grid; // its lowest corner in eye-relative units, and 1 / its length

layout(location = 0) out vec4 o_fluence;
layout(location = 1) out vec4 o_flux[3]; // along each axis

// The surface that stands between p and light i, or behind p
LitSurface surface_towards(int i, vec3 p) {
    bool is_point = i >= DIRECTIONAL_COUNT && i < DIRECTIONAL_COUNT + POINT_COUNT;
    int layer = int(u_lights[i].direction.w) + (is_point ? cube_face(p - u_lights[i].position.xyz) : 0);
    vec4 q = u_shadow_tiles[layer].matrix * vec4(p, 1.0);
    vec2 uv = q.xy / q.w;
    if (q.w <= 0.0 || uv != clamp(uv, 0.0, 1.0)) return LitSurface(vec3(0.0), vec3(0.0));
    return lit_surface(tile_of(layer), floor(uv * u_shadow_tile_size) + 0.5, i);
}

struct Patch {
    vec3 place, normal;
    float a2; // its area / pi
    vec3 power;
    int light;
};

Patch patch_at(int k) {
    vec4 place = texelFetch(u_patches, ivec2(k, 0), 0), normal = texelFetch(u_patches, ivec2(k, 1), 0);
    return Patch(place.xyz, normal.xyz, place.w, texelFetch(u_patches, ivec2(k, 2), 0).rgb, int(normal.w));
}

// A patch of the area A = pi a^2 that is seen from the height h above its plane and the distance r has about the solid
// angle
//   A sqrt(h^2 + a^2) / (r^2 + a^2)^(3/2)
// which is A h / r^3 from afar. Those of all patches of a plane add up to half of the sphere, however near it is.
//
// What keeps the light itself from the cell is taken for a wall that keeps from it what is reflected before it, too.
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float side = 1.0 / (u_grid.w * float(u_side));
    vec3 p = u_grid.xyz + (vec3(pixel.x, pixel.y % u_side, pixel.y / u_side) + 0.5) * side;
    float depth_of_cell = extinction_at(p) * side;
    vec3 fluence = vec3(0.0);
    mat3 flux = mat3(0.0);
    int count = textureSize(u_patches, 0).x, k = 0;
    Patch m = patch_at(0);
    do { // the patches of a light follow each other
        int light = m.light;
        LitSurface wall = surface_towards(light, p);
        float behind = clamp(2.0 * dot(wall.normal, wall.place - p) / side, 0.0, 1.0);
        do {
            vec3 to = m.place - p;
            float height = -dot(m.normal, to), r = length(to), d2 = r * r + m.a2;
            vec3 l = to / max(r, 1e-15);
            float before = clamp(dot(wall.normal, m.place - wall.place) / side, 0.0, 1.0);
            float seen = clamp(height / side + 0.5, 0.0, 1.0) * (1.0 - behind * before); // share of the cell
            float arriving = seen * sqrt(height * height + m.a2) / (d2 * sqrt(d2))
                           * mean_transmittance(media_depth(p, l, r, 4), depth_of_cell);
            fluence += arriving * m.power;
            flux -= outerProduct(arriving * m.power, l);
            m = patch_at(min(++k, count - 1));
        } while (k < count && m.light == light);
    } while (k < count);
    vec3 reflected = INV_PI * u_reflectance;
    o_fluence = vec4(reflected * fluence, 0.0);
    for (int axis = 0; axis < 3; ++axis) o_flux[axis] = vec4(reflected * flux[axis], 0.0);
}
