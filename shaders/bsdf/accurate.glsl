// Functions that stay precise near 0, where the plain expression subtracts nearly equal numbers.

// log(1 + x), x >= 0: 2 artanh(t), t = x / (2 + x), by its series, whose remainder is 1.3e-8 at x = 1/2.
float log_1_plus(float x) {
    float t = x / (2.0 + x);
    float t2 = t * t;
    float series = 2.0 * t * (1.0 + t2 * (1.0 / 3.0 + t2 * (0.2 + t2 * (1.0 / 7.0 + t2 / 9.0))));
    return x < 0.5 ? series : log(1.0 + x);
}

// 1 - exp(-x), x >= 0, to 2e-6; media/one_minus_exp.glsl keeps all digits. Below x = 0.05 by its Taylor series.
float one_minus_exp_fast(float x) {
    return x < 0.05 ? x * (1.0 - x * (0.5 - x * (1.0 / 6.0 - x * (1.0 / 24.0 - x / 120.0)))) : 1.0 - exp(-x);
}
