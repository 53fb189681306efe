// The diffuse base below a dielectric interface. SHOW_DIFFUSE = 0 hides it.
#include "bsdf/lambert.glsl"

vec3 diffuse_response(vec3 base_color) {
    return f_lambert(base_color) * float(SHOW_DIFFUSE);
}

vec3 diffuse_albedo(vec3 base_color) {
    return base_color * float(SHOW_DIFFUSE);
}
