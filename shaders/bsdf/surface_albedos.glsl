// The albedos of the parts of surface.glsl, which includes this file, and the probabilities of sampling them.
#include "sample/luminance.glsl"
#include "sample/share_of.glsl"

// The albedo of single scattering by the facets
vec3 single_albedo(Surface s, SurfaceView v) {
    return MIX_METAL(s, v.dielectric.E_ss, v.metal.E_ss) * float(SHOW_SPECULAR);
}

// The albedo of the diffuse part: multiple scattering by the facets, and the base, whose albedo is (1 - s(o)) rho with
// the albedo s(o) of the interface
vec3 multiple_albedo(Surface s, SurfaceView v) {
    vec3 multiple = MIX_METAL(s, v.dielectric.F_ms, v.metal.F_ms) * energy_loss(v.dfg);
#if IRIDESCENT
    multiple += MIX_METAL(s, v.dielectric.film_multiple, v.metal.film_multiple);
#endif
    vec3 base = MIX_METAL(s, interface_entering(v.dielectric, v.dfg) * diffuse_albedo(s, v.NoV), vec3(0.0));
    return multiple * float(SHOW_MULTISCATTER) + base;
}

#if DIFFUSE_TRANSMISSION
#include "bsdf/diffuse_transmission.glsl"
#endif

// The albedo of all that is not a single reflection
vec3 diffuse_part_albedo(Surface s, SurfaceView v) {
    vec3 albedo = multiple_albedo(s, v);
#if DIFFUSE_TRANSMISSION
    albedo += surface_transmitted(s, v);
#endif
    return albedo;
}

float facet_probability(Surface s, SurfaceView v) {
    float single = luminance(single_albedo(s, v)), diffuse = luminance(diffuse_part_albedo(s, v));
    return diffuse > 0.0 ? share_of(single, diffuse) : 1.0;
}

vec3 base_albedo(Surface s, SurfaceView v) {
    vec3 albedo = single_albedo(s, v) + diffuse_part_albedo(s, v);
#if SHEEN
    albedo = sheen_over(v.sheen, v.sheen.albedo, albedo);
#endif
    return albedo;
}

#if SHEEN
float sheen_probability(Surface s, SurfaceView v) {
    float sheen = luminance(v.sheen.albedo);
    return sheen > 0.0 ? min(sheen / luminance(base_albedo(s, v)), 1.0) : 0.0;
}
#endif
