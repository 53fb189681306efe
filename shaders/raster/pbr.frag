// Physically based shading: the surface of bsdf/surface.glsl under lights and an environment.
#include "raster/material.glsl"
#include "bsdf/surface_of.glsl"
#include "raster/point.glsl"
#if DEFERRED
#include "raster/deferred.glsl"
#endif

// REFLECTS: 0 for a Lambertian surface without an interface.
uniform sampler2D u_dfg;

#if IS_SOLID
uniform vec3 u_absorption; // extinction coefficient sigma_t, per eye-relative unit
#endif

#include "raster/seen_surface.glsl"
#if SCATTERS_INSIDE
#include "raster/from_all_around.glsl"
#endif

#if LIGHT_COUNT > 0
#include "raster/shade_light.glsl"
#endif
#if HAS_ENVIRONMENT || INDIRECT || MEDIA
#include "raster/shade_environment.glsl"
#endif
#if WOVEN
#include "raster/shade_woven.glsl"
#endif
#if HAS_TRANSMISSION
#include "raster/through_surface.glsl"
#endif
#if SUBSURFACE
#include "raster/subsurface.glsl"
#endif
#if SUBSURFACE == 2
#include "raster/gather_subsurface.glsl"
#endif
#if DIFFUSE_TRANSMISSION && IS_SOLID && !SUBSURFACE
#include "raster/crossed_solid.glsl"
#endif

void main() {
#if DEFERRED
    find_surface();
#endif
    MaterialInputs m = read_inputs();
    float covered = coverage(m.base_color.a);
#if !REFLECTS
    m.specular = 0.0;
#endif

    Point p = shaded_point(m);
#if SUBSURFACE
    m.thickness = max(v_interior.z, 0.0);
#endif

#if HAS_TRANSMISSION && SUBSURFACE != 2
    float blur = transmitted_roughness(mean_roughness(m), m.ior);
#endif
    Surface s = surface_of(m);
#if DIFFUSE_TRANSMISSION || SEES_LAMPS_THROUGH
    p.behind = m.thickness;
#if SUBSURFACE
    p.behind = 3.3 * v_interior.x; // a tenth more than the diameter of a ball
#endif
#endif
#if DIFFUSE_TRANSMISSION
    p.returned = vec3(0.0);
#if IS_SOLID && !SUBSURFACE
    s.diffuse_transmission_color *= crossed_solid(s, exp(-u_absorption * m.thickness), p.returned);
#endif
#endif
#if HAS_TRANSMISSION && !IS_SOLID
    s.film_walls = m.transmission;
#endif
#if HAS_TRANSMISSION && REFLECTS && METALNESS != 1 && LIGHT_COUNT > 0
    vec3 lamp_f0 = mix(s.f0, of_both_faces(s.f0), m.transmission), lamp_f90 = vec3(s.f90);
#endif
    SurfaceView view = seen_surface(m, s, p);
#if LIGHT_COUNT > 0
    widen_for_lights(s, view, p);
#endif

    vec3 radiance = vec3(0.0);
#if SHOW_EMISSION
    radiance += m.emissive;
#endif
#if SUBSURFACE
    Interior inside = interior_at(m);
#endif
#if HAS_TRANSMISSION && SUBSURFACE != 2
    vec3 transmitted = transmitted_light(m, p.n, p.n_geometric, p.v, blur);
    radiance += through_surface(m, view, transmitted, s, p);
#if SUBSURFACE && SEES_LAMPS_THROUGH
    p.clear *= inside.unscattered;
#endif
#endif
#if SUBSURFACE == 3
    radiance += interface_entering(view.dielectric, view.dfg) * spread_light(v_position, p.n_geometric);
    s.diffuse_transmission_color = vec3(0.0);
#elif SUBSURFACE
    add_interior(inside, m, s, p);
#endif
#if CLEARCOAT
    radiance *= view.coat.throughput;
#endif
#if HAS_ENVIRONMENT || INDIRECT || MEDIA
    float occlusion = 1.0;
#if OCCLUSION_MAP
    occlusion = 1.0 + u_occlusion_strength * (occlusion_texel().r - 1.0);
#endif
#if VISIBILITY
    vec4 visible = visibility(v_position, p.n_geometric, shading_normal(p.n_geometric));
#elif SKY_SHADOWS
    vec4 visible = visible_past_meshes(p, mean_alpha(s));
#else
    const vec4 visible = vec4(1.0);
#endif
#if !WOVEN
    radiance += shade_environment(p, s, view, occlusion, visible);
#endif
#elif WOVEN
    const float occlusion = 1.0;
    const vec4 visible = vec4(1.0);
#endif
#if WOVEN
    radiance += shade_woven(p, occlusion, visible, covered);
#elif LIGHT_COUNT > 0
#if HAS_TRANSMISSION && REFLECTS && METALNESS != 1
    view.dielectric.f0 = lamp_f0; // lamps meet facets at other angles than that of view (raster/glass_reflectance.glsl)
    view.dielectric.f90 = lamp_f90;
#endif
    int i = 0;
    do {
        radiance += shade_light(i, p, s, view);
    } while (++i < LIGHT_COUNT);
#endif
#if SUBSURFACE == 2
    write_gathered(radiance, view, covered);
#else
    write_radiance(radiance, covered);
#endif
}
