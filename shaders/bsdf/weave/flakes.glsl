// Fibres that lie about parallel, as a medium of small mirrors: the SGGX distribution of Heitz, Dupuy, Crassin &
// Dachsbacher 2015, "The SGGX Microflake Distribution", for fibres along `axis`. With A = 1 + (alpha - 1) axis axis^T,
//   projected area  sigma(w) = |A w|,   D(h) = alpha^3 / (pi (alpha^2 + (1 - alpha^2) (axis . h)^2)^2)
// so that alpha = 0 are cylinders, whose normals are all perpendicular to the axis, and alpha = 1 is a ball.
#include "bsdf/constants.glsl"
#include "sample/hemisphere.glsl"
#include "sample/orthonormal_basis.glsl"

const float FLAKES_LEAST = 0.392; // as in viewer/bake/yarn.py

struct Flakes {
    vec3 axis;   // unit
    float alpha; // in (0, 1]
};

vec3 flakes_scaled(Flakes f, vec3 w) {
    return w + ((f.alpha - 1.0) * dot(f.axis, w)) * f.axis;
}

// The area that the flakes of a unit of volume show to the direction w
float flakes_area(Flakes f, vec3 w) {
    return length(flakes_scaled(f, w));
}

float flakes_density(Flakes f, vec3 h) {
    float c = dot(f.axis, h), a2 = f.alpha * f.alpha;
    float q = a2 + (1.0 - f.alpha) * (1.0 + f.alpha) * c * c;
    return INV_PI * f.alpha * a2 / (q * q);
}

// D(h) of the flakes that mirror light between wo and wi; 0 for wi = -wo, which all that the ray touches mirror
float flakes_mirroring(Flakes f, vec3 wo, vec3 wi) {
    vec3 h = wo + wi;
    float l2 = dot(h, h);
    return l2 > 1e-12 ? flakes_density(f, h * inversesqrt(l2)) : 0.0;
}

// What fibres mirror between two directions with this cosine of the azimuth about them, over what they do at most:
// about Fresnel's reflectance for an index of 1.55, least for light that returns. Its mean over their width is MEAN of
// viewer/bake/yarn.py.
float flakes_fresnel(float cosine) {
    float x = clamp(0.5 + 0.5 * cosine, 0.0, 1.0);
    return FLAKES_LEAST + (1.0 - FLAKES_LEAST) * sqrt((1.0 - x) / (1.0 + sqrt(x))); // 1 - sqrt(x)
}

// A flake that is seen from wo: the ellipsoid of which D has the normals is a ball in the space of A, where what is
// seen from A wo is a cosine lobe. u in [0, 1)^2
vec3 flakes_sample(Flakes f, vec3 wo, vec2 u) {
    mat3 frame = orthonormal_basis(normalize(flakes_scaled(f, wo)));
    return normalize(flakes_scaled(f, frame * sample_cosine_hemisphere(u)));
}
