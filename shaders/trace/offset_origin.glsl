// Moves the origin of a ray off the surface. Waechter & Binder 2019, "A Fast and Robust Method for Avoiding
// Self-Intersection", Ray Tracing Gems, chapter 6: by units in the last place, and by a fixed length near the origin,
// where those units vanish. n is the geometric normal on the side to which the ray leaves.
vec3 offset_origin(vec3 p, vec3 n) {
    ivec3 ulps = ivec3(256.0 * n);
    vec3 moved = intBitsToFloat(floatBitsToInt(p) + ivec3(p.x < 0.0 ? -ulps.x : ulps.x, p.y < 0.0 ? -ulps.y : ulps.y,
                                                          p.z < 0.0 ? -ulps.z : ulps.z));
    return mix(moved, p + n * (1.0 / 65536.0), lessThan(abs(p), vec3(1.0 / 32.0)));
}
