// The vertices of surfaces whose triangles are only numbered.
uniform mat4 u_model;
uniform mat4 u_view_projection;

in vec3 a_position;

void main() {
    vec4 p = u_model * vec4(a_position, 1.0);
    gl_Position = u_view_projection * p;
}
