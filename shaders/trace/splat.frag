// Adds what photons bring to the camera, by blending.
flat in vec4 v_contribution;

layout(location = 0) out vec4 o_sum;     // rgb, number of splats
layout(location = 1) out vec4 o_squares; // of rgb; number of those that were not finite

void main() {
    o_sum = vec4(v_contribution.rgb, 1.0);
    o_squares = vec4(v_contribution.rgb * v_contribution.rgb, v_contribution.w);
}
