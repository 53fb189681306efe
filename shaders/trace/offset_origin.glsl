// Waechter & Binder 2019, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems, chapter 6: off
// the surface by units in the last place, and near the origin, where those vanish, by a fixed length. n is the
// geometric normal on the side the new ray leaves to.
vec3 offset_origin(vec3 p, vec3 n) {
    ivec3 ulps = ivec3(256.0 * n);
    vec3 moved = intBitsToFloat(floatBitsToInt(p) + ivec3(p.x < 0.0 ? -ulps.x : ulps.x, p.y < 0.0 ? -ulps.y : ulps.y,
                                                          p.z < 0.0 ? -ulps.z : ulps.z));
    return mix(moved, p + n * (1.0 / 65536.0), lessThan(abs(p), vec3(1.0 / 32.0)));
}
