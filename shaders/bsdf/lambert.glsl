// The diffuse BRDF f = rho / pi (Lambert 1760).
#include "bsdf/constants.glsl"

vec3 f_lambert(vec3 albedo) {
    return albedo * INV_PI;
}
