// The side from which a path's last vertex receives light, beside the origin of its shadow ray: HAS_LIGHT_TREE needs it
// again where the path hits an emitter. 22 bits of a unit vector, or 0 for light from all around.
#include "sample/octahedron.glsl"

const float FACING_STEPS = 2046.0; // along each axis; even, so that 0 is one of them
const float FACING_SCALE = 8388608.0;

float pack_facing(vec3 n) {
    vec2 steps = floor((to_octahedron(n) * 0.5 + 0.5) * FACING_STEPS + 0.5);
    return (1.0 + steps.x + (FACING_STEPS + 1.0) * steps.y) / FACING_SCALE;
}

vec3 unpack_facing(float facing) {
    if (facing == 0.0) return vec3(0.0);
    int code = int(facing * FACING_SCALE) - 1, columns = int(FACING_STEPS) + 1;
    return from_octahedron(vec2(code % columns, code / columns) * (2.0 / FACING_STEPS) - 1.0);
}
