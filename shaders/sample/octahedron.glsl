// Unit vectors as points of a square. Meyer et al. 2010, "On Floating-Point Normal Vectors"
vec2 fold_octahedron(vec2 p) {
    return (1.0 - abs(p.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0)));
}

vec2 to_octahedron(vec3 d) {
    vec2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
    return d.z < 0.0 ? fold_octahedron(p) : p;
}

vec3 from_octahedron(vec2 p) {
    float z = 1.0 - abs(p.x) - abs(p.y);
    return normalize(vec3(z < 0.0 ? fold_octahedron(p) : p, z));
}

// A point of the square in one number: 11 bits for each coordinate make a whole number, which a float holds exactly.
// All are PACKED or more.
const float PACKED = 2.0, PACKED_LAST = 2047.0;

float pack_octahedron(vec2 p) {
    vec2 steps = floor((clamp(p, -1.0, 1.0) + 1.0) * 0.5 * PACKED_LAST + 0.5);
    return PACKED + steps.x + (PACKED_LAST + 1.0) * steps.y;
}

vec2 unpack_octahedron(float packed_point) {
    float y = floor((packed_point - PACKED) / (PACKED_LAST + 1.0));
    return vec2(packed_point - PACKED - (PACKED_LAST + 1.0) * y, y) / PACKED_LAST * 2.0 - 1.0;
}
