// Directions from rough surfaces to what smooth bodies, the casters, show them of lamps, by the tables of
// viewer/trace/scene/caustic_guide.py. From where a surface is, a caster fills at most a cone about the direction to
// its middle. A square of GUIDE_CELLS x GUIDE_CELLS cells is mapped to the directions of that cone, uniformly.
#include "sample/hemisphere.glsl"
#include "sample/octahedron.glsl"
#include "sample/orthonormal_basis.glsl"

uniform int u_guide_casters; // for each caster: middle, radius
uniform int u_guide_places;  // for each place around it: first of its cells, share of the samples (float bits)
uniform int u_guide_cells;   // for each cell: threshold, alias, density in the square
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

// The inverse of sample_disk
vec2 square_of_disk(vec2 p) {
    bool x_dominates = abs(p.x) > abs(p.y);
    float major = x_dominates ? p.x : p.y, minor = x_dominates ? p.y : p.x;
    if (major == 0.0) return vec2(0.5);
    float r = sign(major) * length(p), along = r * (4.0 / PI) * atan(minor / major);
    return (x_dominates ? vec2(r, along) : vec2(along, r)) * 0.5 + 0.5;
}

// The density of guide_direction by solid angle
float guide_pdf(Guide g, vec3 d) {
    vec3 local = d * g.to_local;
    float rise = dot(local.xy, local.xy) / max(1.0 + local.z, 1e-30); // 1 - z without its loss of digits
    if (local.z <= 0.0 || rise > g.spread) return 0.0;
    vec2 disk = local.xy * inversesqrt(max(g.spread * (2.0 - rise), 1e-30));
    ivec2 cell = clamp(ivec2(square_of_disk(disk) * float(GUIDE_CELLS)), 0, GUIDE_CELLS - 1);
    return uintBitsToFloat(scene_uint4(g.cells + cell.y * GUIDE_CELLS + cell.x).z) / (2.0 * PI * g.spread);
}

vec3 guide_direction(Guide g, vec3 u) {
    vec2 place = u.xy * float(GUIDE_CELLS); // as in sample_environment
    ivec2 cell = min(ivec2(place), GUIDE_CELLS - 1);
    place -= vec2(cell);
    uvec4 entry = scene_uint4(g.cells + cell.y * GUIDE_CELLS + cell.x);
    if (u.z >= uintBitsToFloat(entry.x)) cell = ivec2(int(entry.y) % GUIDE_CELLS, int(entry.y) / GUIDE_CELLS);
    vec2 disk = sample_disk((vec2(cell) + place) / float(GUIDE_CELLS));
    float rise = dot(disk, disk) * g.spread;
    return normalize(g.to_local * vec3(disk * sqrt(g.spread * (2.0 - rise)), 1.0 - rise));
}
