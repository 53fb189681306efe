// The interface of a dielectric or a metal: microfacets that send light back at once, D V F (Cook & Torrance 1982), or
// after several bounces between them (Kulla & Conty 2017). MULTISCATTER: the latter is there. SHOW_SPECULAR and
// SHOW_MULTISCATTER show or leave out the two contributions.
//
// A layer has, as MaterialX's layers do, two answers, of which a stack of layers is made:
//   <layer>_response    f of the light that it sends back itself
//   <layer>_throughput  the share of the light that reaches what lies below and of that which comes back from there
//   f of the stack = response + throughput * f of what lies below
#include "bsdf/constants.glsl"
#include "bsdf/fresnel.glsl"
#include "bsdf/multiscatter.glsl"

// What is the same for all light that falls on it, once it is known from where it is seen
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

// By its largest channel: what lies below keeps its colour
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

// dv = D V, F the reflectance of the facets, dfg_light = (a, b) from where it is lit
vec3 interface_response(Interface face, vec3 F, float dv, vec2 dfg_light) {
    return dv * F * float(SHOW_SPECULAR) + face.multiple * (lost(dfg_light) * float(SHOW_MULTISCATTER));
}

// T(o) T(i) / T_mean, T being `transmitted`: reciprocal, and never more than what came. Kelemen & Szirmay-Kalos 2001,
// "A Microfacet Based Coupled Specular-Matte BRDF Model"
float interface_throughput(Interface face, vec2 dfg_light) {
    return face.through * transmitted(face, dfg_light);
}

// In light from all around: `specular` is the radiance that the split sum's parts a and b see, mean_light the
// irradiance over pi.
vec3 interface_environment(Interface face, vec2 dfg, mat2x3 specular, vec3 mean_light) {
    vec3 single = face.f0 * (dfg.x * specular[0]) + face.f90 * (dfg.y * specular[1]);
    return single * float(SHOW_SPECULAR) + mean_light * face.E_ms * float(SHOW_MULTISCATTER);
}

float interface_environment_throughput(Interface face) {
    return max(1.0 - max3(face.E_ss + face.E_ms), 0.0); // < 0 without masking
}
