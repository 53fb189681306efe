// Geometric specular antialiasing: the lobe is widened by the variance of the normal within a pixel.
// Tokuyoshi & Kaplanyan 2019, "Improved Geometric Specular Antialiasing", eq. 5 with sigma^2 = 1 / (2 pi), kappa =
// 0.18.
float alpha_antialiased(float alpha, vec3 dndx, vec3 dndy) {
    float variance = 0.159154943 * (dot(dndx, dndx) + dot(dndy, dndy));
    return sqrt(min(1.0, alpha * alpha + min(2.0 * variance, 0.18)));
}
