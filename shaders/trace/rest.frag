// Slots that are idle stay so.
layout(location = 0) out vec4 o_origin;

void main() {
    o_origin = vec4(0.0);
}
