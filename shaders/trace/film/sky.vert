// Draws a square of TILE x TILE pixels for each work item, at its tile of the picture.
in ivec4 a_work; // tile x, tile y, first sample, samples

uniform vec2 u_size; // of the picture

flat out int v_samples;

void main() {
    vec2 pixel = vec2((a_work.xy + ivec2(gl_VertexID & 1, gl_VertexID >> 1)) * TILE);
    gl_Position = vec4(2.0 * pixel / u_size - 1.0, 0.0, 1.0);
    v_samples = a_work.w;
}
