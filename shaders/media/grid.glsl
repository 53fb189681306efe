// Volumes: grids of densities in boxes, and of majorants, the greatest densities in cells, which are cubes of voxels.
// viewer/trace/scene/volumes.py writes both. Densities stand at the centres of voxels and are trilinear between them,
// constant from the outermost centres to the faces of the box, and 0 outside of it.
#include "sample/random.glsl"
#include "trace/scene_buffer.glsl"

uniform int u_volumes;      // section of the scene buffer, VOLUME_TEXELS for each volume
uniform int u_volume_count;
uniform sampler2D u_voxels; // densities and majorants, row by row
uniform int u_voxel_shift;  // its width is 2^u_voxel_shift

struct Volume {
    vec4 row0, row1, row2; // tracer space to cells: the box begins at 0, and a cell has the side 1
    ivec3 voxels;          // along each axis
    int first_voxel;       // row in the texture
    ivec3 cells;
    int first_majorant;    // row in the texture
    float cell_size;       // voxels along the side of a cell
    float extinction;      // of the density 1, per tracer unit
};

Volume volume_at(int k) {
    int texel = u_volumes + k * VOLUME_TEXELS;
    uvec4 voxels = scene_uint4(texel + 3), cells = scene_uint4(texel + 4), rest = scene_uint4(texel + 5);
    return Volume(scene_float4(texel), scene_float4(texel + 1), scene_float4(texel + 2),
                  ivec3(voxels.xyz), int(voxels.w), ivec3(cells.xyz), int(cells.w),
                  float(rest.x), uintBitsToFloat(rest.y));
}

float voxel(int row, int i) {
    return texelFetch(u_voxels, ivec2(i & ((1 << u_voxel_shift) - 1), row + (i >> u_voxel_shift)), 0).r;
}

float majorant_of(Volume v, ivec3 cell) {
    return voxel(v.first_majorant, cell.x + v.cells.x * (cell.y + v.cells.y * cell.z));
}

// The density of one of the eight voxels about a point in cells, chosen with the weights of the trilinear interpolation,
// so that its mean is the interpolated density. Wherever the density enters linearly it takes that one's place, at an
// eighth of the memory accesses. One random number makes the three choices, for after each of them it is uniform again.
float random_density_at(Volume v, vec3 point, float u) {
    vec3 index = clamp(point * v.cell_size - 0.5, vec3(0.0), vec3(v.voxels - 1));
    ivec3 at = min(ivec3(index), max(v.voxels - 2, 0));
    vec3 part = index - vec3(at);
    for (int axis = 0; axis < 3; ++axis) {
        bool is_high = u < part[axis];
        u = is_high ? u / part[axis] : (u - part[axis]) / (1.0 - part[axis]);
        at[axis] += int(is_high);
    }
    return voxel(v.first_voxel, at.x + v.voxels.x * (at.y + v.voxels.y * at.z));
}

// A walk along a ray from cell to cell: Amanatides & Woo 1987, "A Fast Voxel Traversal Algorithm for Ray Tracing". The
// distance t is counted from the point where the ray enters the box, so that a distant origin costs no digits.
struct Walk {
    vec3 origin, direction, inverse; // in cells
    ivec3 cell;
    float majorant; // of the cell
    vec3 next;      // where the ray meets the cell's next face of each axis
    float t, end;
    float start;    // of the walk, along the ray
};

// Begins a walk up to the distance `limit`. Returns false if the ray misses the box.
bool enter(Volume v, vec3 origin, vec3 direction, float limit, out Walk w) {
    mat3 turn = mat3(v.row0.xyz, v.row1.xyz, v.row2.xyz);
    vec3 o = origin * turn + vec3(v.row0.w, v.row1.w, v.row2.w);
    vec3 size = vec3(v.voxels) / v.cell_size;
    w.direction = direction * turn;
    vec3 tiny = 1e-12 * max(abs(w.direction.x), max(abs(w.direction.y), abs(w.direction.z))) + vec3(1e-37);
    w.inverse = 1.0 / mix(w.direction, tiny, lessThan(abs(w.direction), tiny));
    vec3 a = -o * w.inverse, b = (size - o) * w.inverse;
    vec3 near = min(a, b), far = max(a, b);
    w.start = max(max(near.x, max(near.y, near.z)), 0.0);
    w.end = min(min(far.x, min(far.y, far.z)), limit) - w.start;
    w.origin = clamp(o + w.start * w.direction, vec3(0.0), size);
    w.cell = clamp(ivec3(w.origin), ivec3(0), v.cells - 1);
    w.next = (vec3(w.cell) + step(0.0, w.inverse) - w.origin) * w.inverse;
    w.t = 0.0;
    if (!(w.end > 0.0)) return false;
    w.majorant = majorant_of(v, w.cell);
    return true;
}

// Goes on until the optical depth `depth` of the majorants lies behind. Returns false at the end of the walk.
bool advance(inout Walk w, Volume v, float depth) {
    while (true) {
        float rate = v.extinction * w.majorant;
        float exit = min(min(w.next.x, w.next.y), min(w.next.z, w.end));
        float reach = rate * max(exit - w.t, 0.0);
        if (depth < reach) {
            w.t = min(w.t + depth / rate, exit);
            return true;
        }
        depth -= reach;
        w.t = exit;
        if (w.t >= w.end) return false;
        int axis = w.next.x <= w.t ? 0 : w.next.y <= w.t ? 1 : 2;
        w.cell[axis] += w.inverse[axis] < 0.0 ? -1 : 1;
        if (w.cell[axis] < 0 || w.cell[axis] >= v.cells[axis]) return false;
        w.next[axis] += abs(w.inverse[axis]);
        w.majorant = majorant_of(v, w.cell);
    }
    return false;
}

// The walk's point, in cells. Rounding must not take it out of its cell, whose majorant would not hold there.
vec3 point_of(Walk w) {
    vec3 low = vec3(w.cell);
    return clamp(w.origin + w.t * w.direction, low, low + 1.0);
}
