// The light of the medium, where the surface reflects or transmits light into it (KHR_materials_transmission), or its
// base lets it through (KHR_materials_diffuse_transmission), which has no direction that it keeps. SUBSURFACE: 1 puts
// it into the base of the surface, beside what that reflects itself; 2 leaves the latter out, for a pass that spreads
// the light over the surface; 3 reads what that pass has found.
#include "raster/interior.glsl"
#if SUBSURFACE == 3
#include "raster/joint_bilateral.glsl"
#endif

uniform vec3 u_interior_attenuation;   // k, per eye-relative unit
uniform vec3 u_interior_extrapolation; // h, in eye-relative units
uniform vec3 u_interior_albedo;        // of single scattering, without what is scattered straight on
uniform vec3 u_interior_reduced;       // 1 - albedo g
uniform float u_interior_entered;      // how deep light enters, as a multiple of what comes from everywhere
uniform float u_interior_reflected;    // F, the share of the light inside that the boundary reflects back
uniform float u_interior_kept;         // what a rough boundary does not lose, on the way in and inside

Interior interior_at(MaterialInputs m) {
    vec3 through = u_absorption * m.thickness;
    return interior_of(u_interior_attenuation, u_interior_extrapolation, u_interior_entered, v_interior.x,
                       clamp(v_interior.y, 0.0, 1.0) * u_interior_albedo, through, u_interior_reduced * through);
}

#if SUBSURFACE == 3
uniform sampler2D u_subsurface, u_subsurface_positions;

vec3 spread_light(vec3 position, vec3 n) {
    return joint_bilateral_fetch(u_subsurface, u_subsurface_positions, position, n, vec3(0.0), vec4(0.0)).rgb;
}
#else
// Makes of the medium two cosine lobes of the surface, one on each side, and what light from all around has beyond
// them.
void add_interior(Interior inside, MaterialInputs m, inout Surface s, inout Point p) {
    vec3 own, other, everywhere, own_diffuse, other_diffuse, everywhere_diffuse;
    leaving_light(inside, vec3(u_interior_reflected), own, other, everywhere);
    vec3 reflected = (1.0 - m.diffuse_transmission) * m.base_color.rgb;
    vec3 through = m.diffuse_transmission * m.diffuse_transmission_color;
    inside.unscattered = inside.straight = vec3(0.0); // nothing is seen through a diffuse boundary
    leaving_light(inside, min(reflected, 0.999), own_diffuse, other_diffuse, everywhere_diffuse);
    vec3 refracted = u_interior_kept * m.transmission * m.base_color.rgb;
    vec3 diffused = (1.0 - m.transmission) * through * through / max(1.0 - reflected, 1e-3);
    own = refracted * own + diffused * own_diffuse;
    other = refracted * other + diffused * other_diffuse;
    p.everywhere = refracted * everywhere + diffused * everywhere_diffuse;
#if SUBSURFACE == 1
    own += (1.0 - m.transmission) * reflected;
#endif
    s.diffuse_transmission = 0.5;
    s.base_color = 2.0 * own;
    s.diffuse_transmission_color = 2.0 * other;
}
#endif
