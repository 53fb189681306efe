// Directions from rough surfaces to what smooth bodies, the casters, show them of lamps, by the tables of
// viewer/trace/scene/caustic_guide.py. From where a surface is, a caster fills at most a cone about the direction to
// its middle. An equal-area map (Lambert's azimuthal one) makes it the unit disk, in a square of GUIDE_CELLS x
// GUIDE_CELLS cells.
#include "sample/octahedron.glsl"
#include "sample/orthonormal_basis.glsl"

uniform int u_guide_casters; // for each caster: middle, radius
uniform int u_guide_places;  // for each place around it: first of its cells, share of the samples (float bits)
uniform int u_guide_cells;   // four cells in a texel, each of 32 bits: share of the samples in 1 / GUIDE_STEPS (16
                             // bits), threshold in GUIDE_CELLS^2 / GUIDE_STEPS (8 bits), alias (8 bits)
uniform int u_guide_count;

struct Guide {
    float share;   // of the samples that are guided; 0: none
    mat3 to_local; // from a frame about the axis of the cone to that of the BSDF
    float spread;  // 1 - cosine of the cone
    int cells;     // texel of the first one
};

const Guide NO_GUIDE = Guide(0.0, mat3(1.0), 1.0, 0);
const float ALWAYS_WORTH = 1e3;

// The guide to the caster that most samples should go to from the point p, in the frame of a BSDF. `share` is that of
// the samples which may be guided.
Guide guide_at(vec3 p, mat3 frame, float share) {
    Guide g = NO_GUIDE;
    g.cells = u_guide_cells; // finite numbers, which a share of 0 then takes no part of
    vec3 axis = vec3(0.0, 0.0, 1.0);
    int k = 0;
    do {
        vec4 caster = scene_float4(u_guide_casters + k);
        vec3 to = caster.xyz - p;
        float squared = max(dot(to, to), 1e-30), ratio = caster.w * caster.w / squared;
        to *= inversesqrt(squared);
        ivec2 place = clamp(ivec2((to_octahedron(-to) * 0.5 + 0.5) * float(GUIDE_PLACES)), 0, GUIDE_PLACES - 1);
        uvec4 found = scene_uint4(u_guide_places + (k * GUIDE_PLACES + place.y) * GUIDE_PLACES + place.x);
        float own = ratio > 2e-8 && ratio < 1.0 ? uintBitsToFloat(found.y) : 0.0;
        if (own > g.share) {
            g.share = own;
            g.spread = ratio / (1.0 + sqrt(1.0 - ratio));
            g.cells = u_guide_cells + int(found.x);
            axis = to;
        }
    } while (++k < u_guide_count);
    g.share *= share;
    g.to_local = transpose(frame) * orthonormal_basis(axis);
    return g;
}

uint guide_cell(Guide g, int cell) {
    return scene_uint4(g.cells + (cell >> 2))[cell & 3];
}

// The density of guide_direction by solid angle
float guide_pdf(Guide g, vec3 d) {
    vec3 local = d * g.to_local;
    vec2 square = local.xy * (0.5 * inversesqrt(g.spread * max(1.0 + local.z, 1e-7))) + 0.5;
    if (square != clamp(square, 0.0, 1.0)) return 0.0;
    ivec2 cell = min(ivec2(square * float(GUIDE_CELLS)), GUIDE_CELLS - 1);
    const float density = float(GUIDE_CELLS * GUIDE_CELLS) / float(8 * GUIDE_STEPS);
    return float(guide_cell(g, cell.y * GUIDE_CELLS + cell.x) >> 16u) * density / g.spread;
}

vec3 guide_direction(Guide g, vec3 u) {
    vec2 place = u.xy * float(GUIDE_CELLS); // as in sample_environment
    ivec2 cell = min(ivec2(place), GUIDE_CELLS - 1);
    place -= vec2(cell);
    uint entry = guide_cell(g, cell.y * GUIDE_CELLS + cell.x);
    int other = int(entry & 255u), threshold = int(entry >> 8u & 255u);
    if (u.z * float(GUIDE_STEPS / (GUIDE_CELLS * GUIDE_CELLS)) >= float(threshold))
        cell = ivec2(other % GUIDE_CELLS, other / GUIDE_CELLS);
    vec2 disk = (vec2(cell) + place) * (2.0 / float(GUIDE_CELLS)) - 1.0;
    float rise = dot(disk, disk) * g.spread; // 1 - z
    return normalize(g.to_local * vec3(disk * sqrt(g.spread * (2.0 - rise)), 1.0 - rise));
}
