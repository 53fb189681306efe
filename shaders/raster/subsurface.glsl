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
uniform float u_interior_reflected;    // F, the share of the light inside that the boundary reflects back
uniform float u_interior_kept;         // what a rough boundary does not lose, on the way in and inside
in vec2 v_interior; // thickness d in eye-relative units, and roundness: 0 a slab, 1 a ball

// The way straight through the solid: d in a slab, and the diameter 3 d of a ball
float way_through() {
    return v_interior.x * mix(1.0, 3.0, clamp(v_interior.y, 0.0, 1.0));
}

// Of the light that is seen through the solid, the share by which it must be dimmed: no more than all of it leaves.
Interior interior_at(MaterialInputs m, out vec3 dimmed) {
    vec3 unscattered = exp(-u_absorption * m.thickness);
    Interior inside = interior_of(u_interior_attenuation, u_interior_extrapolation, v_interior.x,
                                  clamp(v_interior.y, 0.0, 1.0) * u_interior_albedo, unscattered);
    dimmed = inside.unscattered / max(unscattered, 1e-30);
    return inside;
}

#if SUBSURFACE == 3
uniform sampler2D u_subsurface, u_subsurface_positions;

vec3 spread_light(vec3 position, vec3 n) {
    return joint_bilateral_fetch(u_subsurface, u_subsurface_positions, position, n, vec3(0.0), vec4(0.0)).rgb;
}
#else
// Makes of the medium two cosine lobes of the surface, one on each side.
void add_interior(Interior inside, MaterialInputs m, inout Surface s) {
    vec3 own, other, own_diffuse, other_diffuse;
    leaving_light(inside, vec3(u_interior_reflected), own, other);
    vec3 reflected = (1.0 - m.diffuse_transmission) * m.base_color.rgb;
    vec3 through = m.diffuse_transmission * m.diffuse_transmission_color;
    inside.unscattered = vec3(0.0);
    leaving_light(inside, min(reflected, 0.999), own_diffuse, other_diffuse);
    vec3 refracted = u_interior_kept * m.transmission * m.base_color.rgb;
    vec3 diffused = (1.0 - m.transmission) * through * through / max(1.0 - reflected, 1e-3);
    own = refracted * own + diffused * own_diffuse;
    other = refracted * other + diffused * other_diffuse;
#if SUBSURFACE == 1
    own += (1.0 - m.transmission) * reflected;
#endif
    float share = max3(other) / max(max3(own) + max3(other), 1e-6);
    s.diffuse_transmission = share;
    s.base_color = own / max(1.0 - share, 1e-6);
    s.diffuse_transmission_color = other / max(share, 1e-6);
}
#endif
