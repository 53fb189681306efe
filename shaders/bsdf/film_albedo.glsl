// What a film adds to the albedos of an interface, since its reflectance is not in the DFG table. surface_view.glsl
// includes this file.

// The difference that the film makes to Schlick's curve, which the table has
vec3 film_added(Film film, FilmAt at, Interface face, float ior) {
    vec3 F = f_schlick(face.f0, face.f90, at.mu);
    return film_over(film, at, F, ior) - F;
}

void add_film(inout Interface face, vec3 single, vec3 mean_added, vec2 dfg, vec2 mean) {
    face.film_single = single;
#if MULTISCATTER
    vec3 F_mean = clamp(f_schlick_mean(face.f0, face.f90) + mean_added, 0.0, 1.0);
    float mean_loss = energy_loss(mean);
    vec3 F_ms = kulla_conty_fresnel(F_mean, mean_loss);
    face.film_multiple = (F_ms - face.F_ms) * energy_loss(dfg);
    face.f_ms_view = F_ms * (energy_loss(dfg) * INV_PI / max(mean_loss, 1e-4));
#endif
    face.E_ss = max(face.E_ss + single, 0.0);
    face.scaled_transmittance = interface_entering(face, dfg) / max(interface_transmittance(face, mean), 1e-4);
}

// The film's part of the directional albedo is a mean over six visible GGX normals h,
//   E_film(o) - E(o) = (a + b) sum_h w G2(o, i) / G1(o) (F_film(o.h) - F(o.h)) / sum_h w G2(o, i) / G1(o)
// They lie in the cap of Dupuy & Benyoub 2023 ("Sampling Visible GGX Normals with Spherical Caps"), at one side of the
// plane of incidence. Their places and weights are fitted to films of indices 1.2 to 2.2 and 100 to 700 nm, for which
// the error is 0.001 (root mean square) and at most 0.007. The mean over the hemisphere, for light that scatters more
// than once, has two nodes.
void add_film(inout SurfaceView v, Surface s, vec2 dfg_mean) {
    const int NORMALS = 6, MEANS = MULTISCATTER != 0 ? 2 : 0;
    const vec4 NORMAL[NORMALS] = vec4[]( // height in the cap, cosine and sine of the azimuth, weight
        vec4(0.6027, 0.7648, 0.6443, 0.2151), vec4(0.1737, 0.4941, 0.8694, 0.3077),
        vec4(0.336, -0.5978, 0.8017, 0.3002), vec4(0.9104, 0.7154, 0.6987, 0.1114),
        vec4(0.8174, -0.2228, 0.9749, 0.1225), vec4(0.6944, -0.9260, 0.3776, 0.1412));
    const vec2 MEAN[2] = vec2[](vec2(0.3550510, 0.3639172), vec2(0.8449490, 0.6360828)); // cosine, weight
    float alpha = mean_alpha(s), sine = sqrt(max(1.0 - v.NoV * v.NoV, 0.0));
    vec2 o = normalize(vec2(alpha * sine, v.NoV));
    float t_o = sqrt(v.NoV * v.NoV + alpha * alpha * sine * sine), weights = 0.0;
    vec3 dielectric = vec3(0.0), metal = vec3(0.0), dielectric_mean = vec3(0.0), metal_mean = vec3(0.0);
    // One loop serves both means, and none goes over a whole array: such a loop Mesa unrolls whatever its size (NIR's
    // force_unroll), and compiles eight copies of the film.
    int k = 0;
    do {
        float mu, weight = 0.0, mean_weight = 0.0;
        if (k < NORMALS) {
            vec4 normal = NORMAL[k];
            float z = (1.0 - normal.x) * (1.0 + o.y) - o.y, radius = sqrt(max(1.0 - z * z, 0.0));
            vec3 h = vec3(alpha * (radius * normal.y + o.x), alpha * radius * normal.z, max(z + o.y, 1e-6));
            h = normalize(h);
            mu = clamp(sine * h.x + v.NoV * h.z, 0.0, 1.0);
            float NoL = 2.0 * mu * h.z - v.NoV;
            float t_i = sqrt(NoL * NoL + alpha * alpha * max(1.0 - NoL * NoL, 0.0));
            if (NoL > 0.0) weight = normal.w * (v.NoV + t_o) * NoL / (t_o * NoL + t_i * v.NoV);
        } else {
            mu = MEAN[k - NORMALS].x;
            mean_weight = MEAN[k - NORMALS].y;
        }
        weights += weight;
        FilmAt at = film_at(v.film, mu);
#if METALNESS != 1
        vec3 added = film_added(v.film, at, v.dielectric, film_base_ior(s.f0, s.ior));
        dielectric += weight * added;
        dielectric_mean += mean_weight * added;
#endif
#if METALNESS != 0
        vec3 metal_added = film_added(v.film, at, v.metal, 0.0);
        metal += weight * metal_added;
        metal_mean += mean_weight * metal_added;
#endif
    } while (++k < NORMALS + MEANS);
    float scale = (v.dfg.x + v.dfg.y) / max(weights, 1e-6);
#if METALNESS != 1
    add_film(v.dielectric, scale * dielectric, dielectric_mean, v.dfg, dfg_mean);
#endif
#if METALNESS != 0
    add_film(v.metal, scale * metal, metal_mean, v.dfg, dfg_mean);
#endif
}
