// Linear light to sRGB values in [0, 1], by the piecewise function of IEC 61966-2-1. pow(x, 1/2.2) would have errors of
// up to 0.03.
vec3 srgb_from_linear(vec3 c) {
    c = clamp(c, 0.0, 1.0);
    vec3 low = 12.92 * c;
    vec3 high = 1.055 * pow(max(c, 1e-8), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, lessThanEqual(c, vec3(0.0031308)));
}
