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

float quintic(float x, float a, float b, float c, float d, float e, float f) {
    return a + x * (b + x * (c + x * (d + x * (e + x * f))));
}

// The directional albedo of D V alone, for roughnesses from CHARLIE_SMOOTHEST: exp of a polynomial in the fourth root of
// mu and the roughness, fitted to quadrature from above. It is up to 0.005 too large, so that what the fibres take from
// the base is at least what they reflect. Below a cosine of 1e-4 it stays what it is there.
float charlie_unlimited_albedo(float mu, float perceptual_roughness) {
    float s = 2.0 * sqrt(sqrt(clamp(mu, 1e-4, 1.0))) - 1.0;
    float r = 2.5 * perceptual_roughness - 1.5;
    float p = quintic(r, -1.1111, 0.3778, -0.0904, 0.3514, 0.0022, -0.3785);
    p = p * s + quintic(r, 0.3374, 0.9662, -0.3609, -0.5790, 0.0651, 0.3450);
    p = p * s + quintic(r, 0.7990, -0.1157, -0.2997, -0.2301, -0.0294, 0.4721);
    p = p * s + quintic(r, -0.7856, -0.4726, -0.0081, 0.7379, -0.2328, -0.2116);
    p = p * s + quintic(r, -0.1177, 0.2996, -0.1524, 0.3770, -0.2498, -0.0578);
    p = p * s + quintic(r, -0.7592, 0.4594, -0.2712, 0.1416, -0.2879, 0.2047);
    p = p * s + quintic(r, -0.8396, 0.2840, -0.2517, 0.1436, -0.2119, 0.1621);
    p = p * s + quintic(r, -0.3806, 0.2442, 0.1043, -0.2060, 0.0125, -0.0009);
    return exp(p);
}

// The directional albedo E of f. The limit comes before the weight, as in f: dimmed fibres reflect the same share of it.
float charlie_albedo(float mu, float perceptual_roughness) {
    float r = clamp(perceptual_roughness, CHARLIE_SMOOTHEST, 1.0);
    return min(charlie_unlimited_albedo(mu, r), 1.0) * charlie_weight(perceptual_roughness);
}

// f for the cosines NoV and NoL and the sine squared of the half vector. At grazing angles, where D V reflects more than
// all for the smoothest fibres, it is divided by the larger of both directions' albedo.
float charlie(float NoV, float NoL, float s2, float perceptual_roughness) {
    float r = clamp(perceptual_roughness, CHARLIE_SMOOTHEST, 1.0);
    float a = r * r;
    float d = (2.0 + 1.0 / a) * pow(max(s2, 1e-30), 0.5 / a) * 0.5 * INV_PI;
    float v = 0.25 / ((1.0 + charlie_lambda(NoV, a) + charlie_lambda(NoL, a)) * max(NoV * NoL, 1e-12));
    return d * v * charlie_weight(perceptual_roughness) / max(1.0, charlie_unlimited_albedo(min(NoV, NoL), r));
}
