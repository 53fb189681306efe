// What arrives over what is sent: which part of the environment's light a pixel's surface sees.
uniform sampler2D u_arriving;
uniform sampler2D u_sent;
out vec4 o_visible;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 arriving = texelFetch(u_arriving, pixel, 0), sent = texelFetch(u_sent, pixel, 0);
    o_visible = mix(vec4(1.0), arriving / max(sent, 1e-30), greaterThan(sent, vec4(0.0)));
}
