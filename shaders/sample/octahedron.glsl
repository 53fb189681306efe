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
