// A square on the ground, which the lines of the grid are drawn on.
uniform mat4 u_view_projection;
uniform vec3 u_middle;   // of the square, eye-relative
uniform float u_half;    // of its side, in eye-relative units
uniform vec2 u_lines;    // where its middle is, in distances between lines, from a line on
uniform float u_spacing; // of lines, in eye-relative units

out vec2 v_lines; // whole numbers on lines
out vec2 v_away;  // from the middle, 1 at the sides

void main() {
    v_away = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
    vec2 offset = v_away * u_half;
    v_lines = u_lines + offset / u_spacing;
    gl_Position = u_view_projection * vec4(u_middle + vec3(offset.x, 0.0, offset.y), 1.0);
}
