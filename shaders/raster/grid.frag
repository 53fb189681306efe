// Lines one pixel wide at whole numbers. They fade away from the middle, and where they are as dense as pixels.
uniform vec3 u_color, u_x_color, u_z_color; // radiance; of the x axis and of the z axis
uniform vec2 u_zero;                        // the lines on which these axes are
uniform float u_width;                      // in pixels of the target
uniform float u_opacity;

in vec2 v_lines, v_away;
out vec4 o_color; // associated alpha

void main() {
    vec2 pixel = max(fwidth(v_lines), 1e-6);
    vec2 line = round(v_lines);
    vec2 covered = clamp(0.5 * u_width + 0.5 - abs(v_lines - line) / pixel, 0.0, 1.0);
    covered *= clamp(0.5 / pixel - 1.0, 0.0, 1.0);
    float seen = 1.0 - smoothstep(0.3, 1.0, length(v_away));
    // Lines along z have a whole x. The z axis is that of x = 0.
    bool is_x = covered.y > 0.0 && line.y == u_zero.y, is_z = covered.x > 0.0 && line.x == u_zero.x;
    vec3 color = is_z && (!is_x || covered.x > covered.y) ? u_z_color : is_x ? u_x_color : u_color;
    float alpha = max(covered.x, covered.y) * seen * (is_x || is_z ? 1.0 : u_opacity);
    o_color = vec4(color * alpha, alpha);
}
