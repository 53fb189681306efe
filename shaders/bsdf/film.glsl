// A thin film on an interface (KHR_materials_iridescence). What its two faces reflect interferes and is coloured.
// With the reflectance F of the bare interface, for each of the polarisations s and p, which have their mean,
//   R = F + T0 sum_m q^m (1 - cos(m phi)),   phi = 2 pi OPD / wavelength,   OPD = 2 n d cos(angle in the film)
//   q = r12 (r12 - r13) / (1 - r12 r13),   T0 = (1 - r12^2) (1 - r13^2) / ((r12 - r13)^2 + 1 - r13^2)
// r12 is the amplitude that the upper face reflects, r13 that of the bare interface; both are real. It is Airy's sum
// (Born & Wolf 1999, section 7.6) with the lower face r23 that makes a film of thickness 0 the bare interface,
// r13 = (r12 + r23) / (1 + r12 r23). So any Fresnel curve can lie below a film, and a film without thickness, or of
// index 1, leaves it as it is.
//
// The mean of cos(m phi) over the colour matching functions of red, green and blue is a sum of damped cosines of m OPD
// (film_spectrum). The light's spectrum is that of equal energy, and a grey reflectance stays grey.
// Belcour & Barla 2017, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence", also sum
// orders; r13 and both polarisations make this sum that of the spectral integral.
#include "bsdf/constants.glsl"
#include "bsdf/fresnel.glsl"

struct Film {
    float weight;    // 0 leaves the interface bare
    float ior;
    float thickness; // in nm
    float walls;     // the share of light that meets a film on both faces of a thin wall
};

const int FILM_ORDERS = 4;

// A film for light of the cosine mu outside
struct FilmAt {
    float mu;
    vec2 r12;                   // for s and p
    vec2 entering;              // 1 - r12^2
    vec3 spectrum[FILM_ORDERS]; // the mean of 1 - cos(m phi), m = 1 ...
};

// The means of 1 - cos(m phi) over the colour matching functions of Rec. 709 (CIE 1931 by Wyman, Sloan & Shirley 2013,
// each divided by its integral):
//   1 - sum_k color_k exp(-(width_k m OPD)^2) cos(2 pi position_k m OPD),   OPD in micrometres
// A fit to the integral, whose error is 0.0027 (root mean square up to 6 micrometres) and at most 0.016. The colours
// add up to 1, for OPD 0. Beyond the bound of OPD nothing interferes, and float32 has no phase.
void film_spectrum(float opd, out vec3 spectrum[FILM_ORDERS]) {
    const int TERMS = 6;
    const float POSITION[TERMS] = float[](1.6255, 1.7149, 1.9966, 1.836, 2.2642, 2.1343);
    const float WIDTH[TERMS] = float[](0.2909, 0.3887, 0.2362, 0.5833, 0.3669, 0.2716);
    const vec3 COLOR[TERMS] = vec3[](
        vec3(0.8191, -0.241, 0.0126), vec3(1.006, -0.0371, -0.033), vec3(-0.0019, -0.0685, 0.0755),
        vec3(-0.8829, 1.4652, -0.1472), vec3(0.0836, -0.0948, 0.7458), vec3(-0.0239, -0.0238, 0.3463));
    for (int m = 0; m < FILM_ORDERS; ++m) spectrum[m] = vec3(0.0);
    opd = min(opd, 40.0);
    for (int k = 0; k < TERMS; ++k) {
        float x = WIDTH[k] * opd, once = exp(-x * x);
        float c = cos(2.0 * PI * POSITION[k] * opd), before = 1.0, now = c;
        float damped = once, ratio = once * once * once; // exp(-(m x)^2) by its ratios
        for (int m = 0; m < FILM_ORDERS; ++m) {
            spectrum[m] += COLOR[k] * (1.0 - damped * now); // exactly 0 for OPD 0
            float next = 2.0 * c * now - before; // cos((m + 1) a) = 2 cos(a) cos(m a) - cos((m - 1) a)
            before = now;
            now = next;
            damped *= ratio;
            ratio *= once * once;
        }
    }
}

FilmAt film_at(Film film, float mu) {
    FilmAt at;
    at.mu = clamp(mu, 1e-6, 1.0);
    float n2 = film.ior * film.ior;
    // n cos(angle in the film). That of index 1 is mu to the bit, also where sqrt is not exact.
    float g = film.ior == 1.0 ? at.mu : sqrt((film.ior - 1.0) * (film.ior + 1.0) + at.mu * at.mu);
    vec2 far = vec2(g, n2 * at.mu), near = vec2(at.mu, g);
    at.r12 = (near - far) / (near + far);
    at.entering = 4.0 * near * far / ((near + far) * (near + far));
    film_spectrum(2e-3 * film.thickness * g, at.spectrum);
    return at;
}

// The index of what lies below a film, for film_reflectance: 0 for what reflects more than a third at normal incidence
float film_base_ior(vec3 f0, float ior) {
    return max(f0.r, max(f0.g, f0.b)) > 0.35 ? 0.0 : ior;
}

// The bare interface reflects F = (r_s^2 + r_p^2) / 2. Of a dielectric of the index `ior`
//   r_s, r_p = -sqrt(F) (cos(a) +- sin(a)),   tan(a) = tan(outer angle) tan(inner angle)
// is exact if F is, r_p changing its sign at Brewster's angle. For any other F it has the same shares, which needs
// F <= 1/2 at that angle. An interface without an index (`ior` 0) is taken for a metal's: r_s = r_p = -sqrt(F).
vec3 film_reflectance(FilmAt at, vec3 F, float ior) {
    float sin2 = 0.0, side = 1.0; // sin(2 a), the sign of cos(a) - sin(a)
    if (ior >= 1.0) {
        float t2 = 1.0 - at.mu * at.mu, c = at.mu * sqrt((ior - 1.0) * (ior + 1.0) + at.mu * at.mu);
        sin2 = 2.0 * c * t2 / (c * c + t2 * t2);
        side = c >= t2 ? 1.0 : -1.0;
    }
    vec3 apart = min(F * sin2, 1.0 - F); // (r_s^2 - r_p^2) / 2
    vec3 added = vec3(0.0);
    for (int p = 0; p < 2; ++p) {
        vec3 R13 = max(p == 0 ? F + apart : F - apart, 0.0), T13 = 1.0 - R13;
        vec3 r13 = -sqrt(R13) * (p == 0 ? 1.0 : side);
        float r12 = at.r12[p];
        vec3 between = r12 - r13, product = max(1.0 - r12 * r13, 1e-6);
        vec3 q = r12 * between / product;
        vec3 sum = vec3(0.0), power = q;
        for (int m = 0; m < FILM_ORDERS - 1; ++m, power *= q) sum += power * at.spectrum[m];
        // From the last order m on, cos is taken to fall by 1 - D / 2 from one to the next, D = 1 - cos(m phi):
        //   sum_(k >= m) q^k (1 - cos(k phi)) = q^m D (1 - q / 2) / ((1 - q) (1 - q + q D / 2)),
        // where 1 - q = (1 - r12^2) / (1 - r12 r13)
        vec3 D = max(at.spectrum[FILM_ORDERS - 1], 0.0);
        vec3 tail = D * (1.0 - 0.5 * q) / max(at.entering[p] / product + 0.5 * q * D, 1e-6);
        sum = at.entering[p] * sum + power * product * tail;
        added += sum * T13 / max(between * between + T13, 1e-9);
    }
    // Interference can be more saturated than Rec. 709, where a channel falls below 0. It is clamped, so that the
    // reflectance and the transmittance 1 - R of no channel is negative.
    return clamp(F + added, 0.0, 1.0);
}

// F below the film. With two walls, F is R' = 2 R / (1 + R) of both, and each has its film.
vec3 film_over(Film film, FilmAt at, vec3 F, float ior) {
    vec3 bare = F / (1.0 + film.walls * (1.0 - F));
    vec3 R = film_reflectance(at, bare, ior);
    return mix(F, R * (1.0 + film.walls) / (1.0 + film.walls * R), film.weight);
}

vec3 film_over(Film film, float mu, vec3 F, float ior) {
    return film_over(film, film_at(film, mu), F, ior);
}
