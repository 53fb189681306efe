// By the exponent's bits: a compiler that takes it for granted that nothing is NaN must not drop the test.
bool is_finite(vec3 v) {
    return all(notEqual(floatBitsToUint(v) & 0x7f800000u, uvec3(0x7f800000u)));
}
