// Radiance that a surface of pbr.frag reflects from one punctual light or sun, including its shadow.
#include "light/punctual.glsl"
#include "bsdf/pixel_lobe.glsl"
#if SUNS
#include "light/sun.glsl"
#endif
#if SHADOW_LAYERS > 0
#include "light/shadow.glsl"
#endif
#if MEDIA
#include "raster/lit_media.glsl"
#endif

// The fraction of light i, in the direction l, that arrives at a point; n is the geometric normal on the light's side.
float light_visibility(int i, vec3 position, vec3 n, vec3 l) {
    float arriving = 1.0;
#if MEDIA
    arriving = transmittance_to_light(i, position, l);
#endif
#if SHADOW_LAYERS > 0
    float layer = u_lights[i].direction.w;
    if (layer >= 0.0) {
        bool is_point = i >= DIRECTIONAL_COUNT && i < DIRECTIONAL_COUNT + POINT_COUNT;
        arriving *= shadow_visibility(int(layer), is_point, position, n, l, u_lights[i].position.xyz);
    }
#endif
    return arriving;
}

// (a, b) of the split sum for light from l, on either side of the surface; NoL is that of its own side.
vec2 light_albedo(Point p, Surface s, vec3 l, float NoL, float perceptual_roughness) {
#if !REFLECTS
    return vec2(0.0);
#elif ANISOTROPIC
    return facet_albedo(s, vec3((l * p.frame).xy, NoL), perceptual_roughness, u_dfg);
#else
    return facet_albedo(s, vec3(0.0, 0.0, NoL), perceptual_roughness, u_dfg);
#endif
}

#if SCATTERS_INSIDE
// The mean radiance on all sides of a ball, for one of light i's irradiance: max(cos, 0) / pi has the mean 1 / (4 pi).
// Other surfaces are taken to leave as much of it as they do at the point itself, `arriving`, and where the ball faces
// the light.
float mean_on_solid(int i, Point p, vec3 l, float arriving) {
    float radius = 1.5 * v_interior.x;
    float facing = light_visibility(i, v_position + radius * (1.1 * l - p.n), l, l);
    return 0.125 * INV_PI * (arriving + facing);
}
#endif

#if DIFFUSE_TRANSMISSION || SEES_LAMPS_THROUGH
// Light that a surface lets through from behind. Its far side is `behind` away, so that a solid does not shadow itself.
vec3 light_from_behind(int i, Point p, Surface s, SurfaceView view, vec3 l, vec3 irradiance) {
#if SUBSURFACE
    vec3 far_side = v_position + p.behind * l; // on the way to the light, beyond the solid
    float arriving = light_visibility(i, far_side, l, l);
#else
    float arriving = light_visibility(i, v_position - p.behind * p.n_geometric, -p.n_geometric, l);
#endif
    float NoL = -dot(p.n, l);
    vec3 radiance = vec3(0.0);
#if SCATTERS_INSIDE
    radiance += from_all_around(p, s, view) * irradiance * mean_on_solid(i, p, l, arriving);
#endif
    irradiance *= arriving;
#if DIFFUSE_TRANSMISSION
    vec2 dfg = light_albedo(p, s, l, NoL, view.perceptual_roughness);
    radiance += (1.0 - p.returned) * surface_transmission(s, view, dfg) * irradiance * NoL;
#endif
#if SEES_LAMPS_THROUGH
    // A wedge bends light, a slab lets it go straight on. What both boundaries make of it then is the mirror image of a
    // reflected lobe.
    l = normalize(l + p.bent);
    NoL = max(-dot(p.n, l), 0.0);
    vec3 up = l + 2.0 * NoL * p.n, h = normalize(p.v + up), nxh = cross(p.n, h);
    float NoH = dot(p.n, h);
    float sine2 = dot(nxh, nxh), alpha2 = p.clear_alpha * p.clear_alpha;
    float alpha = p.clear_alpha;
#if IS_SOLID
    alpha *= sqrt(1.0 - sine2 / (3.0 * (sine2 + NoH * NoH * alpha2)));
#endif
    radiance += p.clear * d_microfacet(NoH, sine2, alpha) * v_microfacet(p.NoV, NoL, NoH, dot(p.v, h), alpha)
        * irradiance * NoL;
#endif
#if CLEARCOAT
    radiance *= view.coat.throughput;
#endif
    return radiance;
}
#endif

vec3 shade_light(int i, Point p, Surface s, SurfaceView view) {
    vec3 l;
    vec3 irradiance = punctual_irradiance(i, v_position, l);
    float NoL = dot(p.n, l);
    vec3 between = p.v + l;
    vec3 h = between * inversesqrt(max(dot(between, between), 1e-30));
#if SUNS
    float radius2 = u_lights[i].intensity.w;
#else
    const float radius2 = 0.0;
#endif
    vec3 slopes_x = D_DX(h - p.n), slopes_y = D_DY(h - p.n); // derivatives are undefined after a fragment returns
#if CLEARCOAT
    vec3 coat_x = D_DX(h - view.coat.n), coat_y = D_DY(h - view.coat.n);
#endif
#if DIFFUSE_TRANSMISSION || SEES_LAMPS_THROUGH
    if (NoL < 0.0) return light_from_behind(i, p, s, view, l, irradiance);
#endif
#if CLEARCOAT
    float coat_NoL = dot(view.coat.n, l);
    if ((NoL <= 0.0 && coat_NoL <= 0.0) || h == vec3(0.0)) return vec3(0.0);
    NoL = max(NoL, 0.0);
#else
    if (NoL <= 0.0 || h == vec3(0.0)) return vec3(0.0); // straight from behind there is no half vector
#endif
    float arriving = light_visibility(i, v_position, p.n_geometric, l);
#if SCATTERS_INSIDE
    vec3 of_solid = from_all_around(p, s, view) * irradiance * mean_on_solid(i, p, l, arriving);
#endif
    irradiance *= arriving;
#if ANISOTROPIC
    vec3 wo = p.v * p.frame;
    Angles a = local_angles(vec3(wo.xy, max(wo.z, 1e-4)), l * p.frame);
#else
    vec3 nxh = cross(p.n, h);
    Angles a = Angles(p.NoV, NoL, clamp(dot(p.n, h), 0.0, 1.0), clamp(dot(p.v, h), 0.0, 1.0), dot(nxh, nxh));
#endif
#if ANISOTROPIC
    vec3 tangent = p.frame[0];
#else
    const vec3 tangent = vec3(0.0);
#endif
    float d; // at the point for Blinn-Phong's lobe, and for a sun where normals are alike within a texel
    if (NDF < 2 && (radius2 == 0.0 || p.facet_alpha * p.facet_alpha < 0.999 * p.alphas.x * p.alphas.y)) {
        d = d_over_pixel(p.alphas, p.facet_alpha, tangent, p.n, h, slopes_x, slopes_y);
        s.alpha_t = p.alphas.x;
        s.alpha = p.alphas.y;
    } else {
        d = facet_d(s, a);
    }
#if GROOVED
    d *= p.unhidden;
#endif
#if SUNS
    if (radius2 > 0.0) d = min(d, max_sun_d(mean_alpha(s), radius2, a.VoH, slopes_x, slopes_y));
#endif
    vec2 dfg = light_albedo(p, s, l, NoL, view.perceptual_roughness);
    vec3 radiance = surface_response(s, view, a, d * facet_v(s, a), dfg) * irradiance * NoL;
#if DIFFUSE_TRANSMISSION
    radiance += p.returned * surface_transmission(s, view, dfg) * irradiance * NoL;
#endif
#if SCATTERS_INSIDE
    radiance += of_solid;
#endif
#if CLEARCOAT
    vec3 coat = vec3(0.0);
    if (coat_NoL > 0.0) {
        Coat c = view.coat;
        vec3 c_x_h = cross(c.n, h);
        float c_o_h = clamp(dot(c.n, h), 0.0, 1.0);
        float coat_d;
        if (NDF < 2 && (radius2 == 0.0 || p.coat_facet_alpha < 0.999 * p.coat_alpha)) {
            vec2 alphas = vec2(p.coat_alpha);
            coat_d = d_over_pixel(alphas, p.coat_facet_alpha, vec3(0.0), c.n, h, coat_x, coat_y);
            c.alpha = alphas.y;
        } else {
            coat_d = d_microfacet(c_o_h, dot(c_x_h, c_x_h), c.alpha);
        }
#if SUNS
        if (radius2 > 0.0) coat_d = min(coat_d, max_sun_d(c.alpha, radius2, a.VoH, coat_x, coat_y));
#endif
        float dv = coat_d * v_microfacet(c.NoV, coat_NoL, c_o_h, a.VoH, c.alpha);
        vec2 coat_dfg = dfg_albedo(u_dfg, coat_NoL, c.perceptual_roughness);
        coat = coat_response(c, a.VoH, dv, coat_dfg) * irradiance * coat_NoL;
    }
    radiance = coat_over(view.coat, coat, radiance);
#endif
    return radiance;
}
