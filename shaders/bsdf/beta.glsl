// Euler's beta function B(x, y) = integral_0^1 t^(x-1) (1 - t)^(y-1) dt, for x, y >= 1.
#include "bsdf/accurate.glsl"

// The correction terms of Stirling's series for log Gamma: 1 / (12 x) - 1 / (360 x^3) + 1 / (1260 x^5). Their error is
// at most 3e-7 for x >= 3 (Abramowitz & Stegun 1964, 6.1.41).
float stirling_rest(float x) {
    float r = 1.0 / x;
    float r2 = r * r;
    return r * (1.0 / 12.0 - r2 * (1.0 / 360.0 - r2 / 1260.0));
}

// B(x, y) = B(p, q) s (s+1) (s+2) (s+3) / (x (x+1) y (y+1)),  p = x + 2, q = y + 2, s = x + y. Both p and q are at
// least 3, and there Stirling's series, in which the large terms cancel analytically, gives
//   log B(p, q) = log(2 pi) / 2 - log(p q / (p + q)) / 2 - p log(1 + q/p) - q log(1 + p/q) + corrections
float beta(float x, float y) {
    float s = x + y;
    float p = x + 2.0, q = y + 2.0;
    float rests = stirling_rest(p) + stirling_rest(q) - stirling_rest(p + q);
    float exponent = 0.918938533 + rests - p * log_1_plus(q / p) - q * log_1_plus(p / q);
    float shift = (s / x) * ((s + 1.0) / (x + 1.0)) * ((s + 2.0) / y) * ((s + 3.0) / (y + 1.0));
    return shift * exp(exponent) * inversesqrt(p * (q / (p + q)));
}
