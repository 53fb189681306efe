// Mean curvature of the surface, 1 / r on a sphere, from the differences of normals n and positions p between pixels
float curvature(vec3 n, vec3 p) {
    vec3 nx = dFdx(n), ny = dFdy(n), px = dFdx(p), py = dFdy(p);
    return (dot(nx, px) + dot(ny, py)) / max(dot(px, px) + dot(py, py), 1e-18);
}
