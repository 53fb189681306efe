// Visibility of the environment: shadowed over unshadowed light, 1 where there is no light.
uniform sampler2D u_shadowed;
uniform sampler2D u_unshadowed;
out vec4 o_visibility;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 shadowed = texelFetch(u_shadowed, pixel, 0), unshadowed = texelFetch(u_unshadowed, pixel, 0);
    o_visibility = mix(vec4(1.0), shadowed / max(unshadowed, 1e-30), greaterThan(unshadowed, vec4(0.0)));
}
