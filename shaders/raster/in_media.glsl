// The media between the eye and a point: what media_march.frag has stored.
uniform sampler3D u_media;    // at the ends of slices; rgb: light scattered towards the eye, a: 1 - transmittance
uniform vec4 u_media_starts;  // the distances at which three parts of the ray start, and the last ends
uniform vec3 u_media_counts;  // the slices of each part, which are equally long
uniform vec4 u_media_axis;    // the distance of a point: w 0: its length; w 1: its part along xyz (orthographic)
uniform vec2 u_media_pixel;   // 1 / size of the target

struct Haze {
    vec3 light;
    float transmittance;
};

// Within a slice the medium is taken for homogeneous: by (1 - r^f) / (1 - r) of its light has come together after the
// fraction f of it, with r its transmittance.
float fraction_of_slice(float f, float opacity) {
    if (opacity < 0.02) return f * (1.0 + 0.5 * (1.0 - f) * opacity);
    return f > 0.0 ? (1.0 - exp(f * log(max(1.0 - opacity, 1e-30)))) / opacity : 0.0;
}

Haze haze_at(float distance) {
    float count = float(textureSize(u_media, 0).z);
    vec3 parts = clamp((distance - u_media_starts.xyz) / (u_media_starts.yzw - u_media_starts.xyz), 0.0, 1.0);
    float w = dot(parts, u_media_counts);
    float slice = min(floor(w), count - 1.0);
    vec2 uv = gl_FragCoord.xy * u_media_pixel;
    vec4 end = textureLod(u_media, vec3(uv, (slice + 0.5) / count), 0.0);
    vec4 start = slice > 0.0 ? textureLod(u_media, vec3(uv, (slice - 0.5) / count), 0.0) : vec4(0.0);
    float opacity = clamp((end.a - start.a) / max(1.0 - start.a, 1e-20), 0.0, 1.0);
    vec4 there = mix(start, end, fraction_of_slice(w - slice, opacity));
    return Haze(there.rgb, 1.0 - there.a);
}

Haze haze_before(vec3 position) {
    return haze_at(mix(length(position), dot(position, u_media_axis.xyz), u_media_axis.w));
}

// Radiance at `position` as it is seen from the eye
vec3 seen_in_media(vec3 radiance, vec3 position) {
    Haze haze = haze_before(position);
    return radiance * haze.transmittance + haze.light;
}

// The radiance at `position` of what is seen through that point: the picture has the media from the eye on.
vec3 beyond_media(vec3 seen, vec3 position) {
    Haze haze = haze_before(position);
    return max(seen - haze.light, 0.0) / max(haze.transmittance, 1e-4);
}
