// The picture of what stands behind a transmissive surface, as a pyramid of blurred levels
// (viewer/raster/transmission.py).
uniform sampler2D u_backdrop; // associated alpha
uniform mat4 u_view_projection;

const float EDGE = 1.0 / 16.0; // width, in pictures, of the band outside the picture in which its edge pixels fade out

// The picture at `position`, relative to the eye; 0 outside the picture.
vec4 backdrop_at(vec3 position, float blur) {
    vec4 clip = u_view_projection * vec4(position, 1.0);
    vec2 uv = 0.5 + 0.5 * clip.xy / clip.w;
    vec2 outside = max(max(-uv, uv - 1.0), 0.0);
    float seen = clip.w > 0.0 ? 1.0 - smoothstep(0.0, EDGE, max(outside.x, outside.y)) : 0.0;
    float lod = log2(float(textureSize(u_backdrop, 0).x)) * blur;
    return textureLod(u_backdrop, uv, lod) * seen;
}
