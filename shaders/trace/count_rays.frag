// Draws nothing, but where a slot has a ray: as many samples as rays pass an occlusion query.
uniform sampler2D u_origin, u_shadow_vector;
uniform bool u_shadow; // count shadow rays, not the others

void main() {
    ivec2 slot = ivec2(gl_FragCoord.xy);
    float state = texelFetch(u_origin, slot, 0).w;
    bool is_shadowed = state != IDLE && texelFetch(u_shadow_vector, slot, 0).xyz != vec3(0.0);
    if (!(u_shadow ? is_shadowed : state == IN_FLIGHT)) discard;
}
