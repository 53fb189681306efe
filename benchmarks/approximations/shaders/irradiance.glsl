// Irradiance over pi by spherical harmonics (Ramamoorthi & Hanrahan 2001, "An Efficient Representation for Irradiance
// Environment Maps"): the alternative to the renderer's map that `benchmarks.approximations` measures. DEGREE, the
// highest degree of the basis, is 1, 2 or 4: the clamped cosine has no term of degree 3. The constant factors of the
// basis functions are in the coefficients.
uniform vec3 u_sh[DEGREE == 1 ? 4 : DEGREE == 2 ? 9 : 18];

vec3 sh_irradiance_over_pi(vec3 n) {
    float x = n.x, y = n.y, z = n.z;
    vec3 e = u_sh[0] + u_sh[1] * x + u_sh[2] * y + u_sh[3] * z;
#if DEGREE >= 2
    float x2 = x * x, y2 = y * y, z2 = z * z;
    e += u_sh[4] * (x * y) + u_sh[5] * (y * z) + u_sh[6] * (z * x) + u_sh[7] * (3.0 * z2 - 1.0) + u_sh[8] * (x2 - y2);
#endif
#if DEGREE == 4
    e += u_sh[9] * (x * y * (x2 - y2)) + u_sh[10] * (y * z * (3.0 * x2 - y2)) + u_sh[11] * (x * y * (7.0 * z2 - 1.0))
       + u_sh[12] * (y * z * (7.0 * z2 - 3.0)) + u_sh[13] * (z2 * (35.0 * z2 - 30.0) + 3.0)
       + u_sh[14] * (z * x * (7.0 * z2 - 3.0)) + u_sh[15] * ((x2 - y2) * (7.0 * z2 - 1.0))
       + u_sh[16] * (z * x * (x2 - 3.0 * y2)) + u_sh[17] * (x2 * (x2 - 6.0 * y2) + y2 * y2);
#endif
    return max(e, 0.0);
}
