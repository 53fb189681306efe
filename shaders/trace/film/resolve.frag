// Adds the sums of a wavefront to the film by blending. Several blocks may work on one tile; they are added one by one.
// COUNT: the number of textures, 2 or 3
uniform sampler2D u_first, u_second;
#if COUNT == 3
uniform sampler2D u_third;
#endif

flat in ivec2 v_to_texel;

layout(location = 0) out vec4 o_first;
layout(location = 1) out vec4 o_second;
#if COUNT == 3
layout(location = 2) out vec4 o_third;
#endif

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy) + v_to_texel;
    o_first = texelFetch(u_first, texel, 0);
    o_second = texelFetch(u_second, texel, 0);
#if COUNT == 3
    o_third = texelFetch(u_third, texel, 0);
#endif
}
