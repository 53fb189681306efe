// What views of values have in common: docs/views.md. SHOW: 0 base colour, 1 shading normal, 2 normal of the triangle,
// 3 roughness, 4 metalness, 5 texture coordinates, 6 depth, 7 count of fragments; the order of VALUES in
// viewer/settings.py.
//
// The display pass encodes as sRGB, so a value that is shown as value * 255 is decoded here.
const vec3 HAS_NONE = vec3(0.5); // the code of what does not have the quantity

vec3 linear_from_code(vec3 code) {
    vec3 high = pow((code + 0.055) / 1.055, vec3(2.4));
    return mix(high, code / 12.92, lessThanEqual(code, vec3(0.04045)));
}

vec3 code_of_normal(vec3 n) {
    return 0.5 * n + 0.5;
}

#if SHOW == 6
uniform vec3 u_depth_axis; // of the view, from the eye; eye-relative positions times it are the depth as a share of
uniform float u_least_depth; // the whole span, and this is the share where it begins

vec3 code_of_depth(vec3 position) {
    return vec3(clamp(1.0 + u_least_depth - dot(position, u_depth_axis), 0.0, 1.0));
}
#endif
