// glTF's material: a Lambertian base under a dielectric interface, and a metal, mixed by metalness. Under direct light
//   dielectric = (1 - s(o)) (1 - s(i)) / (1 - s_mean) rho / pi + D V F + f_ms,   metal = D V F + f_ms with f0 = rho
// where s is all the interface reflects, its largest channel: reciprocal, and never more than what came.
// Khronos Group 2021, "glTF 2.0 Specification", appendix B; KHR_materials_specular, KHR_materials_ior. The base as
// Kelemen & Szirmay-Kalos 2001, "A Microfacet Based Coupled Specular-Matte BRDF Model"; f_ms by Kulla & Conty 2017.
// Dielectric and metal are evaluated apart and mixed last: the compensation is not linear in f0.
// MULTISCATTER makes up for what single scattering loses. Of what the model has, the three contributions are drawn or
// left out by SHOW_DIFFUSE, SHOW_SPECULAR, SHOW_MULTISCATTER, and add up.
#include "bsdf/fresnel.glsl"
#include "bsdf/lambert.glsl"
#include "bsdf/multiscatter.glsl"

struct Interface {
    vec3 f0;
    vec3 f90;
    vec3 E_ss;      // directional albedo of single scattering
    vec3 E_ms;      // of what scatters more than once, in light from all around
    vec3 F_ms;      // what a point light loses in single scattering and gets out again, as a part
    vec3 multiple;  // f_ms over what is lost on the light's side
    float through;  // what reaches the base over what gets in on the light's side
};

float max3(vec3 c) {
    return max(c.r, max(c.g, c.b));
}

// Of the lobe with F = 1, from its (a, b). Without masking a + b passes 1, and nothing is missing.
float lost(vec2 dfg) {
    return max(1.0 - dfg.x - dfg.y, 0.0);
}

// All that the interface reflects, once or more often
vec3 interface_albedo(Interface face, vec2 dfg) {
    return face.f0 * dfg.x + face.f90 * dfg.y + face.F_ms * lost(dfg);
}

float transmitted(Interface face, vec2 dfg) {
    return max(1.0 - max3(interface_albedo(face, dfg)), 0.0);
}

// dfg = (a, b) of the split sum, from where it is seen; mean, over the hemisphere
Interface make_interface(vec3 f0, vec3 f90, vec2 dfg, vec2 mean) {
    Interface face;
    face.f0 = f0;
    face.f90 = f90;
    face.E_ss = f0 * dfg.x + f90 * dfg.y;
#if MULTISCATTER
    face.E_ms = fdez_aguera_albedo(face.E_ss, f0, f90, dfg.x + dfg.y);
    float mean_loss = lost(mean);
    bool is_lossless = mean_loss < 1e-4; // less than the table's error
    face.F_ms = is_lossless ? vec3(0.0) : kulla_conty_fresnel(f_schlick_mean(f0, f90), mean_loss);
    face.multiple = face.F_ms * (lost(dfg) * INV_PI / max(mean_loss, 1e-4));
#else
    face.E_ms = face.F_ms = face.multiple = vec3(0.0);
#endif
    face.through = transmitted(face, dfg) / max(transmitted(face, mean), 1e-4);
    return face;
}

// f of the interface: dv = D V, F its reflectance at VoH, dfg_light = (a, b) from where it is lit
vec3 interface_response(Interface face, vec3 F, float dv, vec2 dfg_light) {
    return dv * F * float(SHOW_SPECULAR) + face.multiple * (lost(dfg_light) * float(SHOW_MULTISCATTER));
}

// f of what lies below it
vec3 base_response(Interface face, vec3 base_color, vec2 dfg_light) {
    return f_lambert(base_color) * (face.through * transmitted(face, dfg_light) * float(SHOW_DIFFUSE));
}

// F of a dielectric. FRESNEL = 1 (exact) takes Fresnel's curve at this index for Schlick's from f0 to f90; metals keep
// Schlick, their files give only f0.
vec3 dielectric_fresnel(Interface face, float mu, float ior) {
#if FRESNEL == 1
    float f0 = (ior - 1.0) / (ior + 1.0);
    f0 *= f0;
    float exact = f_dielectric(mu, ior);
    return mix(face.f0, face.f90, clamp((exact - f0) / max(1.0 - f0, 1e-6), 0.0, 1.0));
#else
    return f_schlick(face.f0, face.f90, mu);
#endif
}
