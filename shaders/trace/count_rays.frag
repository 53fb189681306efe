// Counts rays with an occlusion query: a fragment survives where the path has a ray, so the query counts the rays.
uniform sampler2D u_origin, u_shadow_vector;
uniform bool u_shadow; // count the shadow rays instead of the others

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float state = sign(texelFetch(u_origin, texel, 0).w);
    bool is_shadowed = state != IDLE && texelFetch(u_shadow_vector, texel, 0).xyz != vec3(0.0);
    if (!(u_shadow ? is_shadowed : state == IN_FLIGHT)) discard;
}
