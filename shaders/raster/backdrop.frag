// One level of the picture behind transmissive surfaces. LEVEL 0 copies the picture. LEVEL 1 halves the level before
// it, filtered by the binomial (1 3 3 1) / 8 in both directions: four bilinear taps, each between texels at 3 : 1.
uniform sampler2D u_source; // its base level is the one we read

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
