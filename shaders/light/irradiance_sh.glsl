// Irradiance as a polynomial in the normal: spherical harmonics of degree 0, 1, 2 and 4 about +Y convolved with the
// cosine (Ramamoorthi & Hanrahan 2001), constants folded in by viewer/bake/irradiance.py.
//   0..3    1, y, y^2, y^4
//   4..6    x, x y, x y^3           7..9    z, z y, z y^3
//   10, 11  C2, C2 y^2              12, 13  S2, S2 y^2           C2 + i S2 = (x + i z)^2
//   14, 15  C3 y, S3 y              16, 17  C4, S4               and so on
#define SH_COUNT 18

// n: unit length
vec3 irradiance_sh(vec3 n, vec3 sh[SH_COUNT]) {
    float y = n.y, y2 = y * y;
    vec2 p1 = n.xz;
    vec2 p2 = vec2(p1.x * p1.x - p1.y * p1.y, 2.0 * p1.x * p1.y);
    vec2 p3 = y * vec2(p2.x * p1.x - p2.y * p1.y, p2.x * p1.y + p2.y * p1.x);
    vec2 p4 = vec2(p2.x * p2.x - p2.y * p2.y, 2.0 * p2.x * p2.y);
    vec3 e = sh[0] + y * sh[1] + y2 * (sh[2] + y2 * sh[3]);
    e += p1.x * (sh[4] + y * (sh[5] + y2 * sh[6]));
    e += p1.y * (sh[7] + y * (sh[8] + y2 * sh[9]));
    e += p2.x * (sh[10] + y2 * sh[11]);
    e += p2.y * (sh[12] + y2 * sh[13]);
    e += p3.x * sh[14] + p3.y * sh[15];
    e += p4.x * sh[16] + p4.y * sh[17];
    return max(e, 0.0);
}
