// How much of the environment's light a surface sees, found beforehand for one sample a pixel. Where that lay on
// another surface, the mean of those about it that lie on this one.
uniform sampler2D u_visibility; // rgb: of what the hemisphere sends, a: of what it reflects
uniform sampler2D u_positions;

// How well the sample at a pixel speaks for a surface: by its distance from the tangent plane, in pixels.
float likeness(ivec2 pixel, vec3 position, vec3 n, float footprint) {
    vec4 there = texelFetch(u_positions, pixel, 0);
    float off = dot(there.xyz - position, n) / footprint;
    return there.w == 0.0 ? 0.0 : 1.0 / (1.0 + 100.0 * off * off);
}

vec4 visibility(vec3 position, vec3 n) {
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(u_visibility, 0) - 1;
    float footprint = length(dFdx(position)) + length(dFdy(position));
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int k = 4; k < 13 && weights < 0.5; ++k) { // the pixel's own first, mostly alone
        ivec2 tap = clamp(pixel + ivec2(k % 3, k / 3 % 3) - 1, ivec2(0), last);
        float weight = likeness(tap, position, n, footprint);
        sum += weight * texelFetch(u_visibility, tap, 0);
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : vec4(1.0);
}
