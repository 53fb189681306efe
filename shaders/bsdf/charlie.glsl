// The lobe of a cloth's fibres: f = D V with the distribution "Charlie" and its masking. Estevez & Kulla 2017,
// "Production Friendly Microfacet Sheen BRDF"; KHR_materials_sheen.
//   D(h) = (2 + 1/alpha) sin(h)^(1/alpha) / (2 pi),   V = 1 / ((1 + Lambda(v) + Lambda(l)) 4 NoV NoL)
// Where fibres are smoother than CHARLIE_SMOOTHEST, a perceptual roughness, the lobe would reflect more light at
// grazing angles than arrives. It then is that of CHARLIE_SMOOTHEST, with a weight that falls to 0 with the roughness.
#include "bsdf/constants.glsl"

const float CHARLIE_SMOOTHEST = 0.2;

float charlie_weight(float perceptual_roughness) {
    return min(perceptual_roughness / CHARLIE_SMOOTHEST, 1.0);
}

// The fit of log Lambda for cosines up to 0.5, eq. 3 of the paper; a is alpha.
float charlie_log_lambda(float x, float a) {
    float t = (1.0 - a) * (1.0 - a);
    float A = mix(21.5473, 25.3245, t), B = mix(3.82987, 3.32435, t), C = mix(0.19823, 0.16801, t);
    return A / (1.0 + B * pow(x, C)) + mix(-1.97760, -1.27393, t) * x + mix(-4.32054, -4.85967, t);
}

float charlie_lambda(float mu, float a) {
    if (mu < 0.5) return exp(charlie_log_lambda(max(mu, 1e-6), a));
    return exp(2.0 * charlie_log_lambda(0.5, a) - charlie_log_lambda(max(1.0 - mu, 1e-6), a));
}

float quartic(float x, float a, float b, float c, float d, float e) {
    return a + x * (b + x * (c + x * (d + x * e)));
}

// The directional albedo E of f: exp of a polynomial in sqrt(mu) and the roughness, fitted to quadrature from
// above: it is up to 0.01 too large, so that what the fibres take from the base is at least what they reflect.
float charlie_albedo(float mu, float perceptual_roughness) {
    float s = 2.0 * sqrt(clamp(mu, 0.0, 1.0)) - 1.0;
    float r = 2.5 * clamp(perceptual_roughness, CHARLIE_SMOOTHEST, 1.0) - 1.5;
    float p = quartic(r, -0.7901, 0.2962, -0.1467, 0.1876, -0.2390);
    p = p * s + quartic(r, 0.1847, 0.4188, -0.6396, 0.3016, 0.0505);
    p = p * s + quartic(r, 0.6271, -0.0119, -0.4340, 0.2164, 0.2613);
    p = p * s + quartic(r, -0.2649, -0.0920, 0.0879, 0.2357, -0.2121);
    p = p * s + quartic(r, -0.5478, 0.2806, -0.1475, 0.4777, -0.4359);
    p = p * s + quartic(r, -1.1331, 0.4908, -0.5048, 0.6949, -0.4084);
    p = p * s + quartic(r, -0.8649, 0.4209, -0.0915, 0.0423, -0.1212);
    return exp(p) * charlie_weight(perceptual_roughness);
}

// f for the cosines NoV and NoL and the sine squared of the half vector. At grazing angles, where E exceeds 1 for the
// smoothest fibres, it is divided by the larger of both directions' E.
float charlie(float NoV, float NoL, float s2, float perceptual_roughness) {
    float r = clamp(perceptual_roughness, CHARLIE_SMOOTHEST, 1.0);
    float a = r * r;
    float d = (2.0 + 1.0 / a) * pow(max(s2, 1e-30), 0.5 / a) * 0.5 * INV_PI;
    float v = 0.25 / ((1.0 + charlie_lambda(NoV, a) + charlie_lambda(NoL, a)) * max(NoV * NoL, 1e-12));
    return d * v * charlie_weight(perceptual_roughness) / max(1.0, charlie_albedo(min(NoV, NoL), r));
}
