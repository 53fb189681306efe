// A displayed picture with fewer pixels than the target, stretched over all of it.
uniform sampler2D u_picture; // filtered between texels, in sRGB, as browsers enlarge pictures

in vec2 v_ndc;
out vec4 o_color;

void main() {
    o_color = textureLod(u_picture, v_ndc * 0.5 + 0.5, 0.0);
}
