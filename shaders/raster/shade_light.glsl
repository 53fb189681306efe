// A surface of pbr.frag under a light that has no size, or a sun's: Cook-Torrance over the base, and its shadow.

vec3 shade_light(int i, Surface s, vec3 n_geometric) {
    vec3 l;
    vec3 irradiance = punctual_irradiance(i, v_position, l);
    float NoL = dot(s.n, l);
    vec3 h = normalize(s.v + l);
#if SUNS
    vec3 slopes_x = dFdx(h - s.n), slopes_y = dFdy(h - s.n); // before any of four fragments returns
#endif
    if (NoL <= 0.0) return vec3(0.0);
#if SHADOW_LAYERS > 0
    float layer = u_lights[i].direction.w;
    if (layer >= 0.0) {
        bool is_point = i >= DIRECTIONAL_COUNT && i < DIRECTIONAL_COUNT + POINT_COUNT;
        irradiance *= shadow_visibility(int(layer), is_point, v_position, n_geometric, l, u_lights[i].position.xyz);
    }
#endif
    float NoH = clamp(dot(s.n, h), 0.0, 1.0);
    float VoH = clamp(dot(s.v, h), 0.0, 1.0);
    vec3 nxh = cross(s.n, h);
    float d = d_microfacet(NoH, dot(nxh, nxh), s.alpha);
#if SUNS
    float radius2 = u_lights[i].intensity.w;
    if (radius2 > 0.0) d = min(d, most_of_sun(s.alpha, radius2, VoH, slopes_x, slopes_y));
#endif
    float dv = d * v_microfacet(s.NoV, NoL, NoH, VoH, s.alpha);
#if REFLECTS
    vec2 dfg = dfg_albedo(u_dfg, NoL, s.perceptual_roughness);
#else
    const vec2 dfg = vec2(0.0);
#endif
    vec3 f = vec3(0.0);
#if METALNESS != 1
    f += (METALNESS == 2 ? 1.0 - s.metallic : 1.0)
       * (interface_response(s.dielectric, dielectric_fresnel(s.dielectric, VoH, s.ior), dv, dfg)
          + base_response(s.dielectric, s.base_color, dfg));
#endif
#if METALNESS != 0
    f += (METALNESS == 2 ? s.metallic : 1.0)
       * interface_response(s.metal, f_schlick(s.metal.f0, s.metal.f90, VoH), dv, dfg);
#endif
    return f * irradiance * NoL;
}
