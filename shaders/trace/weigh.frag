// Adds up what the points of trace/weigh.vert have, by blending.
flat in vec2 v_light;

out vec4 o_light;

void main() {
    o_light = vec4(v_light, 0.0, 1.0);
}
