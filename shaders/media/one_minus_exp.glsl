// 1 - exp(-x) and -log(1 - x) with all their digits: GLSL has neither expm1 nor log1p. The plain forms lose digits of a
// small x, and 5 % of the value at 1e-6.

// 1 - exp(-x) for x >= 0. Below 1/2 the Taylor series x - x^2 / 2 + x^3 / 6 - ..., whose next term is 1e-8 of the sum.
float one_minus_exp(float x) {
    if (x > 0.5) return 1.0 - exp(-x);
    float series = 1.0 - x / 8.0;
    for (float k = 7.0; k > 1.0; --k) series = 1.0 - x / k * series;
    return x * series;
}

vec3 one_minus_exp(vec3 x) {
    return vec3(one_minus_exp(x.x), one_minus_exp(x.y), one_minus_exp(x.z));
}

// -log(1 - x) for x in [0, 1). Below 1/2 as 2 artanh z = 2 (z + z^3 / 3 + z^5 / 5 + ...), where z = x / (2 - x) <= 1/3.
float minus_log_one_minus(float x) {
    if (x > 0.5) return -log(1.0 - x);
    float z = x / (2.0 - x), z2 = z * z;
    float series = 1.0 / 15.0;
    for (float k = 13.0; k > 0.0; k -= 2.0) series = 1.0 / k + z2 * series;
    return 2.0 * z * series;
}
