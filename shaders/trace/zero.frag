// Sums that begin anew.
layout(location = 0) out vec4 o_first;
layout(location = 1) out vec4 o_second;
layout(location = 2) out vec4 o_third; // goes nowhere where there are two

void main() {
    o_first = o_second = o_third = vec4(0.0);
}
