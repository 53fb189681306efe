// Light scattered by a hair, or another smooth fibre, seen from near: Chiang et al. 2016, "A Practical and Controllable
// Hair and Fur Model for Production Path Tracing", on d'Eon et al. 2011 and Marschner et al. 2003.
//
// Local frame: x along the fibre, from root to tip; y and z span the normal plane. wo points to the viewer, wi to the
// light. Both lie anywhere on the sphere: light that leaves on the far side of the fibre counts as leaving where the
// ray has entered. h in [-1, 1] is the offset at which the ray enters; fibre_offset() gives it and its sign.
//   vec3  fibre_eval(Fibre f, float h, vec3 wo, vec3 wi)     f |cos theta_i|, theta_i the angle to the normal plane
//   vec3  fibre_sample(Fibre f, float h, vec3 wo, vec4 u, out vec3 wi, out float pdf)     the weight, fibre_eval / pdf
//   float fibre_pdf(Fibre f, float h, vec3 wo, vec3 wi)      density of fibre_sample with respect to solid angle
//   vec3  fibre_albedo(Fibre f, float h, vec3 wo)            integral of fibre_eval over the sphere, at most 1
// The model is not reciprocal, since what is absorbed depends on theta_o alone. It is where |theta_i| = |theta_o| and
// the fibre is not tilted, as a mean over h.
#include "bsdf/constants.glsl"
#include "bsdf/fibre/longitudinal.glsl"
#include "bsdf/fibre/azimuthal.glsl"
#include "bsdf/fibre/attenuation.glsl"

struct Fibre {
    vec3 sigma_a;  // absorption per radius of the fibre
    float beta_m;  // roughness along the fibre, in [0, 1]
    float beta_n;  // roughness about it, in [0, 1]
    float tilt;    // of the scales, in radians; R lies at theta_o - 2 tilt, as in pbrt and Mitsuba
    float eta;     // index of refraction over that outside, >= 1
};

// Narrower lobes are widened to this. Their width, sqrt(v) or s, is then 1e-3, which float32 directions resolve.
const float MIN_FIBRE_VARIANCE = 4e-6; // of R; TT has a quarter
const float MIN_FIBRE_SCALE = 1e-3;

// The four lobes R, TT, TRT and the rest for one offset and wo
struct FibreLobes {
    mat4x3 attenuation; // A, a column for each lobe
    vec4 variance;      // of M
    vec2 mean[4];       // of theta_i, as (cos, sin)
    vec2 turn[3];       // exp(i (phi_i - phi_o)) of the middle of N; the last lobe has none
    float scale;        // of N
};

float pow20(float x) {
    float x4 = x * x * x * x;
    return x4 * x4 * x4 * x4 * x4;
}

// Chiang et al., eq. 7 and section 4.1
float fibre_variance(float beta_m) {
    float root = beta_m * (0.726 + 0.812 * beta_m) + 3.7 * pow20(beta_m);
    return max(root * root, MIN_FIBRE_VARIANCE);
}

// Chiang et al., eq. 8, times sqrt(pi / 8)
float fibre_scale(float beta_n) {
    float s = beta_n * (0.265 + 1.194 * beta_n) + 5.372 * beta_n * beta_n * pow20(beta_n);
    return max(0.626657069 * s, MIN_FIBRE_SCALE);
}

// The offset at which a ray from wo meets the fibre, from the normal there (perpendicular to the fibre): the sine of
// the angle from the normal to wo, from y towards z. A frame whose z axis is the normal has h = -wo.y / length(wo.yz).
float fibre_offset(vec3 normal, vec3 wo) {
    float h = normal.y * wo.z - normal.z * wo.y;
    return clamp(h * inversesqrt(max(dot(wo.yz, wo.yz) * dot(normal.yz, normal.yz), 1e-36)), -1.0, 1.0);
}

// The direction in the normal plane; along the fibre any will do
vec2 fibre_azimuth(vec3 w) {
    float l = length(w.yz);
    return l > 0.0 ? w.yz / l : vec2(1.0, 0.0);
}

FibreLobes fibre_lobes(Fibre f, float offset, vec3 wo) {
    float h = clamp(offset, -1.0, 1.0);
    vec2 theta = vec2(length(wo.yz), wo.x);
    vec2 gamma_o = vec2(sqrt((1.0 - h) * (1.0 + h)), h);
    FibreWay inside = fibre_way(h, theta.x, f.eta);

    FibreLobes lobes;
    lobes.attenuation = fibre_attenuation(f.sigma_a, inside.way, theta.x * gamma_o.x, f.eta);
    lobes.variance = fibre_variance(f.beta_m) * vec4(1.0, 0.25, 4.0, 4.0);
    lobes.scale = fibre_scale(f.beta_n);

    // theta_i is about -(theta_o - 2 tilt), -(theta_o + tilt), -(theta_o + 4 tilt), -theta_o (Chiang et al., section
    // 4.1). Beyond a right angle it turns to the other side of the fibre.
    vec2 t1 = vec2(cos(f.tilt), sin(f.tilt));
    vec2 t2 = complex_product(t1, t1);
    lobes.mean = vec2[4](complex_product(theta, conjugate(t2)), complex_product(theta, t1),
                         complex_product(theta, complex_product(t2, t2)), theta);
    for (int p = 0; p < 4; ++p) lobes.mean[p] = vec2(abs(lobes.mean[p].x), -lobes.mean[p].y);

    // Phi_p = 2 p gamma_t - 2 gamma_o + p pi (Marschner et al. 2003, eq. 9)
    vec2 crossing = -complex_product(inside.gamma_t, inside.gamma_t);
    lobes.turn[0] = conjugate(complex_product(gamma_o, gamma_o));
    lobes.turn[1] = complex_product(lobes.turn[0], crossing);
    lobes.turn[2] = complex_product(lobes.turn[1], crossing);
    return lobes;
}

// M N of each lobe: its density in wi with respect to solid angle
vec4 fibre_densities(FibreLobes lobes, vec3 wo, vec3 wi) {
    vec2 theta = vec2(length(wi.yz), wi.x);
    vec2 phi = complex_product(fibre_azimuth(wi), conjugate(fibre_azimuth(wo)));
    vec4 density = vec4(0.5 * INV_PI);
    for (int p = 0; p < 3; ++p) density[p] = azimuthal(complex_product(phi, conjugate(lobes.turn[p])), lobes.scale);
    for (int p = 0; p < 4; ++p) density[p] *= longitudinal(theta, lobes.mean[p], lobes.variance[p]);
    return density;
}

// The probability of sampling each lobe: by its brightest channel, so that the weight of a sample is at most the sum
// of these over the lobes. 0 if nothing is scattered.
vec4 fibre_chances(FibreLobes lobes) {
    vec4 chance;
    for (int p = 0; p < 4; ++p) {
        vec3 A = lobes.attenuation[p];
        chance[p] = max(max(A.r, A.g), A.b);
    }
    return chance / max(dot(chance, vec4(1.0)), 1e-30);
}

vec3 fibre_eval(Fibre f, float h, vec3 wo, vec3 wi) {
    FibreLobes lobes = fibre_lobes(f, h, wo);
    return lobes.attenuation * fibre_densities(lobes, wo, wi);
}

float fibre_pdf(Fibre f, float h, vec3 wo, vec3 wi) {
    FibreLobes lobes = fibre_lobes(f, h, wo);
    return dot(fibre_chances(lobes), fibre_densities(lobes, wo, wi));
}

vec3 fibre_albedo(Fibre f, float h, vec3 wo) {
    return fibre_lobes(f, h, wo).attenuation * vec4(1.0); // every M N integrates to 1
}

// u in [0, 1)^4: the lobe, two numbers for M, one for N. The weight and the pdf are 0 if nothing is scattered.
vec3 fibre_sample(Fibre f, float h, vec3 wo, vec4 u, out vec3 wi, out float pdf) {
    FibreLobes lobes = fibre_lobes(f, h, wo);
    vec4 chance = fibre_chances(lobes);
    int p = 0;
    for (float rest = u.x - chance[0]; rest >= 0.0 && p < 3; rest -= chance[p]) ++p;
    vec2 theta = longitudinal_sample(lobes.mean[p], lobes.variance[p], u.yz);
    float around = 2.0 * PI * u.w;
    vec2 phi = p < 3 ? complex_product(lobes.turn[p], azimuthal_sample(lobes.scale, u.w))
        : vec2(cos(around), sin(around));
    wi = normalize(vec3(theta.y, theta.x * complex_product(fibre_azimuth(wo), phi)));
    vec4 density = fibre_densities(lobes, wo, wi);
    pdf = dot(chance, density);
    return pdf > 0.0 ? lobes.attenuation * density / pdf : vec3(0.0);
}
