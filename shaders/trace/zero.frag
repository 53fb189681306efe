// Sets the sums of blocks to 0.
layout(location = 0) out vec4 o_first;
layout(location = 1) out vec4 o_second;
layout(location = 2) out vec4 o_third; // has no effect where there are two textures

void main() {
    o_first = o_second = o_third = vec4(0.0);
}
