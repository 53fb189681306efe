// The interface of a dielectric or a metal. Its microfacets reflect light once, D V F (Cook & Torrance 1982), or after
// several bounces between them (Kulla & Conty 2017), which the switch MULTISCATTER compiles. SHOW_SPECULAR and
// SHOW_MULTISCATTER show or hide the two contributions.
//
// As in MaterialX, a layer has two functions, from which a stack of layers is composed:
//   <layer>_response    f of the light that the layer itself scatters back
//   <layer>_throughput  the fraction of light that passes the layer on its way to the layers below and back again
//   f of the stack = response + throughput * f of the layers below
#include "bsdf/constants.glsl"
#include "bsdf/fresnel.glsl"
#include "bsdf/multiscatter.glsl"
#if IRIDESCENT
#define TRANSMITTANCE vec3 // what enters below a film has the complement of its colour
#else
#define TRANSMITTANCE float
#endif

// The terms that depend on the direction of the viewer but not on that of the light. T is the transmittance.
struct Interface {
    vec3 f0;
    vec3 f90;
    vec3 E_ss;                  // directional albedo of single scattering
    vec3 F_ms;                  // fraction of the light missing in single scattering that leaves after several bounces
    vec3 f_ms_view;             // f of multiple scattering / (1 - E(l)), l the direction to the light
    TRANSMITTANCE scaled_transmittance; // T(v) / T_mean
#if IRIDESCENT
    vec3 film_single;           // what a film adds to E_ss
    vec3 film_multiple;         // and to the albedo of multiple scattering (bsdf/film_albedo.glsl)
#endif
#if DIFFUSE_ROUGH
    float dimming;              // how much darker what lies below is at grazing angles; see interface_dimming
#endif
};

float max3(vec3 c) {
    return max(c.r, max(c.g, c.b));
}

// 1 - E, the light missing in single scattering with F = 1, from (a, b) of the split sum. Without masking a + b may
// exceed 1, and no light is missing.
float energy_loss(vec2 dfg) {
    return max(1.0 - dfg.x - dfg.y, 0.0);
}

// The directional albedo of the interface: single and multiple scattering
vec3 interface_albedo(Interface face, vec2 dfg) {
    return face.f0 * dfg.x + face.f90 * dfg.y + face.F_ms * energy_loss(dfg);
}

// The fraction T of light that enters. It uses the albedo's largest channel, so that it does not tint the layers below.
float interface_transmittance(Interface face, vec2 dfg) {
    return max(1.0 - max3(interface_albedo(face, dfg)), 0.0);
}

// The same for the view, whose (a, b) is dfg, and below a film
TRANSMITTANCE interface_entering(Interface face, vec2 dfg) {
#if IRIDESCENT
    return max(interface_transmittance(face, dfg) - face.film_single - face.film_multiple, 0.0);
#else
    return interface_transmittance(face, dfg);
#endif
}

#if DIFFUSE_ROUGH
// x of T(i) / T_mean = 1 - x ((1 - NoL)^5 - 1/21). mean_b is the mean of the split sum's b, 1/21 for a smooth interface
// and less for a rough one, whose curve is flatter, too: the second factor is a fit.
float interface_dimming(vec3 f0, vec3 f90, float mean_transmittance, float mean_b) {
    float share = 21.0 * mean_b;
    float x = share * (max3(f90) - max3(f0)) / max(mean_transmittance, 1e-3);
    return max(x * (1.0 + 2.0 * share) / 3.0, 0.0);
}
#endif

// dfg = (a, b) of the split sum for NoV, mean = their means over the hemisphere
Interface make_interface(vec3 f0, vec3 f90, vec2 dfg, vec2 mean) {
    Interface face;
    face.f0 = f0;
    face.f90 = f90;
    face.E_ss = f0 * dfg.x + f90 * dfg.y;
#if MULTISCATTER
    float mean_loss = energy_loss(mean);
    face.F_ms = kulla_conty_fresnel(f_schlick_mean(f0, f90), mean_loss);
    face.f_ms_view = face.F_ms * (energy_loss(dfg) * INV_PI / max(mean_loss, 1e-4)); // below is an error of the table
#else
    face.F_ms = face.f_ms_view = vec3(0.0);
#endif
#if IRIDESCENT
    face.film_single = face.film_multiple = vec3(0.0);
#endif
    face.scaled_transmittance = interface_entering(face, dfg) / max(interface_transmittance(face, mean), 1e-4);
#if DIFFUSE_ROUGH
    face.dimming = interface_dimming(f0, f90, interface_transmittance(face, mean), mean.y);
#endif
    return face;
}

// f of the interface. dv = D V, F = the Fresnel reflectance of the facets, dfg_light = (a, b) of the split sum for NoL
vec3 interface_response(Interface face, vec3 F, float dv, vec2 dfg_light) {
    return dv * F * float(SHOW_SPECULAR) + face.f_ms_view * (energy_loss(dfg_light) * float(SHOW_MULTISCATTER));
}

// T(v) T(l) / T_mean. It is reciprocal and conserves energy. Kelemen & Szirmay-Kalos 2001, "A Microfacet Based Coupled
// Specular-Matte BRDF Model". A film changes T(v) alone, so that a white stack stays white; this is not reciprocal.
TRANSMITTANCE interface_throughput(Interface face, vec2 dfg_light) {
    return face.scaled_transmittance * interface_transmittance(face, dfg_light);
}

// Radiance reflected from an environment. specular[0] and specular[1] are its radiance, filtered for the parts a and b
// of the split sum; mean_light is irradiance / pi.
vec3 interface_environment(Interface face, vec2 dfg, mat2x3 specular, vec3 mean_light) {
    vec3 single = face.f0 * (dfg.x * specular[0]) + face.f90 * (dfg.y * specular[1]);
    vec3 multiple = face.F_ms * energy_loss(dfg); // the albedo of the lobe that lights are reflected by
#if IRIDESCENT
    single = max(single + face.film_single * (specular * dfg) / max(dfg.x + dfg.y, 1e-4), 0.0);
    multiple += face.film_multiple;
#endif
    return single * float(SHOW_SPECULAR) + mean_light * multiple * float(SHOW_MULTISCATTER);
}
