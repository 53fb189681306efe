// Physically based shading: the surface of bsdf/surface.glsl under lights and an environment.
#include "raster/material.glsl"
#include "bsdf/surface_of.glsl"
#include "raster/normal.glsl"
#if DEFERRED
#include "raster/deferred.glsl"
#endif
#if SPECULAR_AA
#include "bsdf/specular_aa.glsl"
#endif
#if NORMAL_MAP || CLEARCOAT_NORMAL_MAP
#include "bsdf/normal_spread.glsl"
#endif
#if GROOVED
#include "bsdf/grooves.glsl"
uniform sampler2D u_normal_root; // of the covariance of the map's normals

vec3 normal_root() {
    return map_texel(u_normal_root, NORMAL_UV, NORMAL_TRANSFORM, u_normal_transform, NORMAL_MIRROR).xyz;
}
#endif
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif
#if VISIBILITY
#include "raster/visibility.glsl"
#endif
#if TRACED_REFLECTION
#include "raster/traced_reflection.glsl"
#endif
#if TRACED_REFRACTION
#include "raster/traced_refraction.glsl"
#endif
#if LIGHT_COUNT > 0
#include "light/punctual.glsl"
#endif
#if SUNS
#include "light/sun.glsl"
#endif
#if SHADOW_LAYERS > 0
#include "light/shadow.glsl"
#endif
#if MEDIA
#include "raster/lit_media.glsl"
#endif
#if IS_ORTHOGRAPHIC
uniform vec3 u_view_direction; // towards the eye
#endif

// REFLECTS: 0 for a Lambertian surface without an interface.
uniform sampler2D u_dfg;

#if IS_SOLID
uniform vec3 u_absorption; // extinction coefficient sigma_t, per eye-relative unit
#endif

#include "raster/sees_lamps_through.glsl"
#if SUBSURFACE && SEES_LAMPS_THROUGH
in vec3 v_other_side; // its normal, outwards, not normalised
#endif

// The normals of the surface, and the direction v to the eye
struct Point {
    vec3 n, n_geometric, v;
    float NoV;
#if DIFFUSE_TRANSMISSION || SEES_LAMPS_THROUGH
    float behind;  // distance to the other side, 0 if thin-walled
#endif
#if DIFFUSE_TRANSMISSION
    vec3 returned; // share of the light that the diffuse transmission brings from this side, 0 if thin-walled
#endif
#if SEES_LAMPS_THROUGH
    vec3 clear;        // share of the light from behind that passes without being scattered inside
    float clear_alpha; // roughness of both boundaries together, as that of a reflected lobe
    vec3 bent;         // what lies straight behind, less what is seen there
#endif
#if ANISOTROPIC
    mat3 frame; // tangent, bitangent, n
#endif
#if GROOVED
    float unhidden; // what the lobe would reflect without masking, as a multiple of what it does
#endif
};

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
#include "raster/transmission.glsl"
#endif
#if SEES_LAMPS_THROUGH
#include "raster/see_lamps.glsl"
#endif
#if SUBSURFACE == 3
#include "raster/joint_bilateral.glsl"
#endif
#if SUBSURFACE
#include "raster/subsurface.glsl"
#endif
#if SUBSURFACE == 2
layout(location = 1) out vec4 o_position; // w: the instance, from 1
layout(location = 2) out vec4 o_profile;  // s of Burley's profile
uniform float u_instance;
uniform vec3 u_interior_shape;            // s, per eye-relative unit
#endif

#if DIFFUSE_TRANSMISSION && IS_SOLID && !SUBSURFACE
// A solid is taken for a slab. Light enters either side with t color, a of it is not absorbed on its way across, and each
// side returns (1 - t) rho of it. With r = (1 - t) rho a, the inside of a side gets t color a / (1 - r^2) of the light
// that falls on the other side, and r times as much of its own: t color a / (1 - r) in all, r / (1 + r) of it its own.
vec3 crossed_solid(Surface s, vec3 a, out vec3 own) {
    vec3 r = min((1.0 - s.diffuse_transmission) * s.base_color * a, 0.999);
    own = r / (1.0 + r);
    return s.diffuse_transmission * s.diffuse_transmission_color * a / (1.0 - r);
}
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

    Point p;
    p.n_geometric = geometric_normal();
    p.n = shading_normal(p.n_geometric);
    p.v = -normalize(v_position);
#if IS_ORTHOGRAPHIC
    p.v = u_view_direction;
#endif
#if SUBSURFACE == 2
    p.v = p.n;
#endif
    p.NoV = clamp(dot(p.n, p.v), 1e-4, 1.0);
#if SUBSURFACE
    m.thickness = way_through();
#endif
#if ANISOTROPIC
    p.frame = anisotropy_frame(m, p.n);
#endif

#if HAS_TRANSMISSION && SUBSURFACE != 2
    float blur = transmitted_roughness(mean_roughness(m), m.ior);
#endif
    m.perceptual_roughness = clamp(m.perceptual_roughness, MIN_PERCEPTUAL_ROUGHNESS, 1.0);
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
    s.f0 = mix(s.f0, thin_walled_f0(s.f0), m.transmission);
    s.film_walls = m.transmission;
#endif
#if NORMAL_MAP && HAS_TANGENT && !GROOVED
    s.alpha = widened_alpha(s.alpha, normal_texel(), u_normal_scale);
    s.alpha_t = widened_alpha(s.alpha_t, normal_texel(), u_normal_scale);
#endif
#if SPECULAR_AA
    s.alpha = alpha_antialiased(s.alpha, D_DX(p.n), D_DY(p.n));
    s.alpha_t = alpha_antialiased(s.alpha_t, D_DX(p.n), D_DY(p.n));
#endif
#if SPECULAR_AA || ANISOTROPIC || NORMAL_MAP
    float perceptual_roughness = table_roughness(s);
#else
    float perceptual_roughness = m.perceptual_roughness;
#endif

#if REFLECTS
#if ANISOTROPIC
    vec2 seen = facet_albedo(s, p.v * p.frame, perceptual_roughness, u_dfg);
    vec4 dfg = vec4(seen, facet_mean(s, perceptual_roughness, u_dfg));
#else
    vec4 dfg = dfg_albedo_and_mean(u_dfg, p.NoV, perceptual_roughness);
#endif
    SurfaceView view = view_surface(s, p.NoV, perceptual_roughness, dfg.xy, dfg.zw);
#else
    SurfaceView view = view_surface(s, p.NoV, perceptual_roughness, vec2(0.0), vec2(0.0));
#endif

#if SHEEN
    view.sheen = sheen_of(s, view, u_dfg);
#endif

#if GROOVED
    // Texels do not hide each other as facets do: what they reflect together is what each of them would.
    vec2 alphas = both_alphas(s);
    stretch_lobe(alphas, p.frame, normal_texel().xyz, normal_root(), u_normal_scale, map_axes());
    s.alpha_t = alphas.x;
    s.alpha = alphas.y;
    view.perceptual_roughness = table_roughness(s);
    vec2 hiding = facet_albedo(s, p.v * p.frame, view.perceptual_roughness, u_dfg);
    p.unhidden = clamp((dfg.x + dfg.y) / max(hiding.x + hiding.y, 1e-3), 1.0, 2.0);
#endif

    vec3 radiance = vec3(0.0);
#if SHOW_EMISSION
    radiance += m.emissive;
#endif
#if CLEARCOAT
    float coat_alpha = max(s.coat_alpha, MIN_PERCEPTUAL_ROUGHNESS * MIN_PERCEPTUAL_ROUGHNESS);
    vec3 n_coat = coat_normal(p.n_geometric);
#if CLEARCOAT_NORMAL_MAP && HAS_TANGENT
    coat_alpha = widened_alpha(coat_alpha, clearcoat_normal_texel(), u_clearcoat_normal_scale);
#endif
#if SPECULAR_AA
    coat_alpha = alpha_antialiased(coat_alpha, D_DX(n_coat), D_DY(n_coat));
#endif
    view.coat = make_coat(s.coat, coat_alpha, n_coat, clamp(dot(n_coat, p.v), 1e-4, 1.0), u_dfg);
#endif
#if SUBSURFACE
    vec3 dimmed;
    Interior inside = interior_at(m, dimmed);
#endif
#if HAS_TRANSMISSION && SUBSURFACE != 2
    vec3 transmitted = transmitted_light(m, p.n, p.n_geometric, p.v, blur);
#if SUBSURFACE
    transmitted *= dimmed;
#endif
    TRANSMITTANCE throughput = surface_throughput(s, view) * m.transmission;
#if SEES_LAMPS_THROUGH
    see_lamps(m, s, throughput, p);
#if SUBSURFACE
    p.clear *= inside.unscattered;
#endif
#endif
#if SHEEN
    transmitted *= view.sheen.throughput;
#endif
    radiance += throughput * entering_tint(m.base_color.rgb) * transmitted * float(SHOW_SPECULAR);
    s.base_color *= 1.0 - m.transmission; // the rest is scattered diffusely
#if DIFFUSE_TRANSMISSION
    s.diffuse_transmission_color *= 1.0 - m.transmission;
#endif
#endif
#if SUBSURFACE == 3
    radiance += interface_environment_throughput(view.dielectric) * spread_light(v_position, p.n_geometric);
    s.diffuse_transmission_color = vec3(0.0);
#elif SUBSURFACE
    add_interior(inside, m, s);
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
    vec4 visible = visibility(v_position, p.n_geometric, p.n);
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
    for (int i = 0; i < LIGHT_COUNT; ++i) radiance += shade_light(i, p, s, view);
#endif
#if SUBSURFACE == 2
    // What the surface takes from light that leaves it along the normal is given back.
    o_color = vec4(radiance / max(interface_environment_throughput(view.dielectric), 1e-3), 1.0);
    o_position = vec4(v_position, u_instance);
    o_profile = vec4(u_interior_shape, 0.0);
    drop_uncovered(covered);
#else
    write_radiance(radiance, covered);
#endif
}
