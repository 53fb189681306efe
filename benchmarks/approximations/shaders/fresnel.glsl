// Fresnel's curve by other ways than the renderer's: the alternatives that `benchmarks.approximations` measures.
#include "bsdf/fresnel_metal.glsl"
#include "bsdf/layer/dielectric.glsl"

// As the renderer has it, exact where FRESNEL = 1
vec3 interface_fresnel(float mu, float ior, float f0) {
    Interface face;
    face.f0 = vec3(f0);
    face.f90 = vec3(1.0);
    return dielectric_fresnel(face, mu, ior);
}

vec3 f_schlick_by_pow(vec3 f0, float mu) {
    return f0 + (1.0 - f0) * pow(1.0 - mu, 5.0);
}

// (1 - mu)^5 ~ 2^((-5.55473 mu - 6.98316) mu)
// Lagarde 2012, "Spherical Gaussian Approximation for Blinn-Phong, Phong and Fresnel"
vec3 f_schlick_gaussian(vec3 f0, float mu) {
    return f0 + (1.0 - f0) * exp2((-5.55473 * mu - 6.98316) * mu);
}
