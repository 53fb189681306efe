// Sums that begin anew.
layout(location = 0) out vec4 o_first;
layout(location = 1) out vec4 o_second;

void main() {
    o_first = o_second = vec4(0.0);
}
