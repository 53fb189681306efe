// One triangle that covers the whole target, on the far plane. Its corners follow from gl_VertexID.
//
// The rays through its pixels are interpolated. For every eight pixels llvmpipe gathers each number of a uniform anew and
// checks its place, which takes longer than to multiply it.
uniform mat3 u_ray, u_ray_origin; // (x, y, 1) in normalised device coordinates to a ray's direction, and to its start

out vec2 v_ndc;
noperspective out vec3 v_ray, v_ray_origin;

void main() {
    v_ndc = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
    v_ray = u_ray * vec3(v_ndc, 1.0);
    v_ray_origin = u_ray_origin * vec3(v_ndc, 1.0);
    gl_Position = vec4(v_ndc, 1.0, 1.0);
}
