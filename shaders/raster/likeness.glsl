// What was found beforehand for one sample a pixel. Where that lay on another surface, the mean of those about it that
// lie on this one; `nothing` where there are none.

// How well the sample at a pixel speaks for a surface: by its distance from the tangent plane, in pixels.
float likeness(vec4 there, vec3 position, vec3 n, float footprint) {
    float off = dot(there.xyz - position, n) / footprint;
    return there.w == 0.0 ? 0.0 : 1.0 / (1.0 + 100.0 * off * off);
}

vec4 look_up(sampler2D found, sampler2D positions, vec3 position, vec3 n, vec4 nothing) {
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(found, 0) - 1;
    float footprint = length(dFdx(position)) + length(dFdy(position));
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int k = 4; k < 13 && weights < 0.5; ++k) { // the pixel's own first, mostly alone
        ivec2 tap = clamp(pixel + ivec2(k % 3, k / 3 % 3) - 1, ivec2(0), last);
        float weight = likeness(texelFetch(positions, tap, 0), position, n, footprint);
        sum += weight * texelFetch(found, tap, 0);
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : nothing;
}
