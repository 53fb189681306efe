// The lines of line.vert. A pixel is covered as far as a line of this width covers it, were it at a right angle to the
// pixel's sides. Short lines are fainter: where triangles are no larger than pixels, lines would hide all of the
// picture.
uniform vec4 u_color;        // radiance, opacity
uniform float u_width;
uniform float u_full_length; // in pixels: shorter lines are fainter

noperspective in float v_across;
flat in float v_length;
out vec4 o_color; // associated alpha

void main() {
    float covered = clamp(0.5 * u_width + 0.5 - abs(v_across), 0.0, min(u_width, 1.0));
    float alpha = u_color.a * covered * min(v_length / u_full_length, 1.0);
    o_color = vec4(u_color.rgb * alpha, alpha);
}
