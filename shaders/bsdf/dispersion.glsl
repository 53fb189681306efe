// Dispersion: the index of refraction depends on the wavelength, in nm, by Cauchy's equation with the Abbe number V.
//   n(lambda) = n_d + (n_d - 1) / V (523655 / lambda^2 - 1.5168),  at least 1,   V = 20 / dispersion
// KHR_materials_dispersion. Red, green and blue are means over bands, triangles about these wavelengths. Centres and
// widths (standard deviations times sqrt(6)) are those of the positive parts of Rec. 709's colour matching functions,
// from the fits of Wyman, Sloan & Shirley 2013 to CIE 1931.
const vec3 BAND_CENTER = vec3(609.0, 541.0, 452.0), BAND_WIDTH = vec3(63.0, 69.0, 52.0);

float dispersed_ior(float ior, float dispersion, float cauchy) {
    return max(ior + (ior - 1.0) * dispersion * 0.05 * cauchy, 1.0);
}

float ior_at_wavelength(float ior, float dispersion, float wavelength) {
    return dispersed_ior(ior, dispersion, 523655.0 / (wavelength * wavelength) - 1.5168);
}

// The mean index of each band
vec3 ior_of_bands(float ior, float dispersion) {
    return vec3(dispersed_ior(ior, dispersion, -0.0973), dispersed_ior(ior, dispersion, 0.2871),
                dispersed_ior(ior, dispersion, 1.0634));
}

// A wavelength for the number u in [0, 1), from one of the bands, each with probability 1/3; and the weight of red,
// green and blue, the density of their band over that of the sample. Its mean is 1.
float sample_wavelength(float u, out vec3 weight) {
    int band = min(int(u * 3.0), 2);
    float t = 2.0 * (u * 3.0 - float(band)) - 1.0; // in [-1, 1)
    float x = sign(t) * (1.0 - sqrt(1.0 - abs(t)));
    float wavelength = BAND_CENTER[band] + BAND_WIDTH[band] * x;
    vec3 density = max(1.0 - abs(wavelength - BAND_CENTER) / BAND_WIDTH, 0.0) / BAND_WIDTH;
    weight = density / max(dot(density, vec3(1.0 / 3.0)), 1e-9);
    return wavelength;
}
