// Lambert 1760: f = rho / pi, the uniform diffuse contribution.
#include "bsdf/constants.glsl"

vec3 f_lambert(vec3 albedo) {
    return albedo * INV_PI;
}
