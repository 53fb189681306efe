// Copies the status of idle paths to the next state.
layout(location = 0) out vec4 o_origin;

void main() {
    o_origin = vec4(0.0);
}
