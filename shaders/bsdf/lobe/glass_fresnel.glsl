// The reflectance of glass's facets: a number, or below a film a colour, whose mean is then the probability of
// reflection.
#include "bsdf/fresnel.glsl"
#if IRIDESCENT
#include "bsdf/film.glsl"
#define REFLECTANCE vec3

// f0 and f90 are those of the bare interface for light from outside, whose exact curve is scaled to them. From inside,
// light that leaves meets the film at the angle that it has outside: Fresnel's term is the same both ways.
vec3 filmed_glass(vec3 f0, vec3 f90, Film film, float mu, float eta) {
    float R = f_dielectric(mu, eta), eta_f0 = f0_from_eta(eta);
    if (R >= 1.0) return vec3(1.0);
    float outside = eta < 1.0 ? sqrt(max(1.0 - (1.0 - mu * mu) / (eta * eta), 0.0)) : mu;
    vec3 F = mix(f0, f90, clamp((R - eta_f0) / max(1.0 - eta_f0, 1e-6), 0.0, 1.0));
    return film_over(film, outside, F, film_base_ior(f0, max(eta, 1.0 / eta)));
}

float mean_of(vec3 F) {
    return dot(F, vec3(1.0 / 3.0));
}

vec3 over_mean(vec3 F, float mean) {
    return F / max(mean, 1e-30);
}
#else
#define REFLECTANCE float

float mean_of(float F) {
    return F;
}

vec3 over_mean(float F, float mean) {
    return vec3(1.0);
}
#endif
