// What was found beforehand for one sample a pixel, at the points that are shaded, which may be several a pixel: between
// the samples about a point, by those that lie on its surface; `nothing` where none does.
uniform vec2 u_drawn_size; // of the picture in points that are shaded

// How well a sample speaks for a surface: by its distance from the tangent plane, in pixels.
float likeness(vec4 there, vec3 position, vec3 n, float footprint) {
    float off = dot(there.xyz - position, n) / footprint;
    return there.w == 0.0 ? 0.0 : 1.0 / (1.0 + 100.0 * off * off);
}

vec4 look_up(sampler2D found, sampler2D positions, vec3 position, vec3 n, vec4 nothing) {
    vec2 scale = vec2(textureSize(found, 0)) / u_drawn_size, at = gl_FragCoord.xy * scale;
    ivec2 pixel = ivec2(at), last = textureSize(found, 0) - 1;
    vec2 off = at - vec2(pixel) - 0.5;
    ivec2 side = ivec2(off.x < 0.0 ? -1 : 1, off.y < 0.0 ? -1 : 1);
    float footprint = (length(dFdx(position)) + length(dFdy(position))) / scale.x;
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    // The four about the point, bilinearly; only where most of them lie elsewhere the pixel's other neighbours
    for (int k = 0; k < 12 && (k < 4 || weights < 0.5); ++k) {
        ivec2 corner = ivec2(k & 1, k >> 1);
        vec2 near = k < 4 ? mix(1.0 - abs(off), abs(off), vec2(corner)) : vec2(1.0);
        if (near.x * near.y == 0.0) continue;
        ivec2 away = k < 4 ? corner * side : ivec2((k + 1) % 3, (k + 1) / 3 % 3) - 1;
        ivec2 tap = clamp(pixel + away, ivec2(0), last);
        float weight = near.x * near.y * likeness(texelFetch(positions, tap, 0), position, n, footprint);
        sum += weight * texelFetch(found, tap, 0);
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : nothing;
}
