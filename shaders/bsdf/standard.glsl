// glTF's material under direct light: a Lambertian base under a dielectric interface, and a metal, mixed by metalness.
//   dielectric = (1 - F) rho / pi + D V F,   metal = D V F with f0 = rho,   both compensated for multiple scattering
// Khronos Group 2021, "glTF 2.0 Specification", appendix B; KHR_materials_specular, KHR_materials_ior.
// Dielectric and metal are evaluated apart and mixed last: the compensation is not linear in f0.
// MULTISCATTER makes up for what single scattering loses. Of what the model has, the three contributions are drawn or
// left out by SHOW_DIFFUSE, SHOW_SPECULAR, SHOW_MULTISCATTER, and add up.
#include "bsdf/fresnel.glsl"
#include "bsdf/lambert.glsl"
#include "bsdf/multiscatter.glsl"

struct Interface {
    vec3 f0;
    vec3 f90;
    vec3 E_ss;   // directional albedo of single scattering
    vec3 E_ms;   // of what scatters more than once
    vec3 gain;   // the same as a part of D V F, under a point light
};

// dfg = (a, b) of the split sum, from where it is seen
Interface make_interface(vec3 f0, vec3 f90, vec2 dfg) {
    Interface face;
    face.f0 = f0;
    face.f90 = f90;
    face.E_ss = f0 * dfg.x + f90 * dfg.y;
#if MULTISCATTER
    face.E_ms = fdez_aguera_albedo(face.E_ss, f0, f90, dfg.x + dfg.y);
    face.gain = turquin_factor(f0, dfg.x + dfg.y) - 1.0;
#else
    face.E_ms = face.gain = vec3(0.0);
#endif
    return face;
}

float max3(vec3 c) {
    return max(c.r, max(c.g, c.b));
}

// What is drawn of D V F with its compensation, as a factor.
vec3 shown_reflection(Interface face) {
    return float(SHOW_SPECULAR) + face.gain * float(SHOW_MULTISCATTER);
}

// f of the dielectric, dv = D V, F the interface's reflectance at VoH
vec3 dielectric_response(Interface face, vec3 base_color, vec3 F, float dv) {
#if SHOW_DIFFUSE
    vec3 f = (1.0 - max3(F)) * f_lambert(base_color);
#else
    vec3 f = vec3(0.0);
#endif
    return f + dv * F * shown_reflection(face);
}

vec3 metal_response(Interface face, float VoH, float dv) {
    return dv * f_schlick(face.f0, face.f90, VoH) * shown_reflection(face);
}
