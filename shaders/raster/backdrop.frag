// A level of the picture behind what transmits light. LEVEL 0: the picture itself. 1: half the size of the one before,
// filtered by the binomial (1 3 3 1) / 8 both ways: four bilinear taps between its texels, 3 parts to 1.
uniform sampler2D u_source; // its base level is the one to read

out vec4 o_color;

void main() {
#if LEVEL == 0
    o_color = texelFetch(u_source, ivec2(gl_FragCoord.xy), 0);
#else
    vec2 texel = 1.0 / vec2(textureSize(u_source, 0));
    vec2 uv = gl_FragCoord.xy * texel * 2.0;
    o_color = 0.25 * (textureLod(u_source, uv + texel * vec2(-0.75, -0.75), 0.0)
                    + textureLod(u_source, uv + texel * vec2(0.75, -0.75), 0.0)
                    + textureLod(u_source, uv + texel * vec2(-0.75, 0.75), 0.0)
                    + textureLod(u_source, uv + texel * vec2(0.75, 0.75), 0.0));
#endif
}
