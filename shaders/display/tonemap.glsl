// Tone maps: from linear radiance after exposure to linear display light in [0, 1].
//   TONEMAP: 0 none, 1 Khronos PBR Neutral, 2 AgX, 3 ACES

#if TONEMAP == 1
// Khronos PBR Neutral (2024): base colours under grey light do not change; only highlights are compressed.
vec3 tonemap(vec3 c) {
    const float start = 0.8 - 0.04;
    const float desaturation = 0.15;
    float x = min(c.r, min(c.g, c.b));
    c -= x < 0.08 ? x - 6.25 * x * x : 0.04;
    float peak = max(c.r, max(c.g, c.b));
    if (peak < start) return c;
    const float d = 1.0 - start;
    float new_peak = 1.0 - d * d / (peak + d - start);
    c *= new_peak / peak;
    float g = 1.0 / (desaturation * (peak - new_peak) + 1.0);
    return mix(vec3(new_peak), c, g);
}
#elif TONEMAP == 2
// AgX (Sobotka 2022): Rec. 709 colours are transformed to a wider gamut (inset), encoded by log2 between -12.47 and
// +4.03 EV, mapped by a sigmoid, and transformed back (outset). The sigmoid is a sixth-order fit: Wrensch 2023,
// "Minimal AgX Implementation".
vec3 tonemap(vec3 c) {
    const mat3 inset = mat3(0.842479062253094, 0.0423282422610123, 0.0423756549057051,
                            0.0784335999999992, 0.878468636469772, 0.0784336,
                            0.0792237451477643, 0.0791661274605434, 0.879142973793104);
    const mat3 outset = mat3(1.19687900512017, -0.0528968517574562, -0.0529716355144438,
                             -0.0980208811401368, 1.15190312990417, -0.0980434501171241,
                             -0.0990297440797205, -0.0989611768448433, 1.15107367264116);
    const float min_ev = -12.47393, max_ev = 4.026069;
    c = clamp((log2(max(inset * max(c, 0.0), 1e-10)) - min_ev) / (max_ev - min_ev), 0.0, 1.0);
    vec3 x2 = c * c, x4 = x2 * x2;
    c = 15.5 * x4 * x2 - 40.14 * x4 * c + 31.96 * x4 - 6.868 * x2 * c + 0.4298 * x2 + 0.1191 * c - 0.00232;
    return pow(clamp(outset * c, 0.0, 1.0), vec3(2.2)); // the sigmoid's output is encoded with gamma 2.2
}
#elif TONEMAP == 3
// ACES filmic: Stephen Hill's fit of RRT + ODT, with the pre-exposure 1 / 0.6 that three.js uses.
vec3 tonemap(vec3 c) {
    const mat3 to_rrt = mat3(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
    const mat3 from_odt = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
    c = to_rrt * (min(c, 1e6) / 0.6); // the limit keeps the squares of the fit within float32
    c = (c * (c + 0.0245786) - 0.000090537) / (c * (0.983729 * c + 0.4329510) + 0.238081);
    return clamp(from_odt * c, 0.0, 1.0);
}
#else
vec3 tonemap(vec3 c) {
    return c;
}
#endif
