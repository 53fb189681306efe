// How lamps are seen through glass and thin wax: where, how much of them, and how much they are blurred.
#if SUBSURFACE
in vec3 v_other_side; // its normal, outwards, not normalised
#endif

// `throughput` is what the surface lets through.
void see_lamps(MaterialInputs m, Surface s, TRANSMITTANCE throughput, inout Point p) {
    p.clear = throughput * m.base_color.rgb * float(SHOW_SPECULAR);
    p.bent = vec3(0.0);
    p.clear_alpha = mean_alpha(s); // a wall has a lobe of reflection, mirrored
#if IS_SOLID
    // Each boundary turns light by (ior - 1) times the slope of its facets; a mirror does by twice the slope. The
    // slopes of both together have the peak 1 / (3 pi alpha^2), as facets of sqrt(3) alpha do, and the tail of sqrt(2)
    // alpha.
    float clear_alpha = 0.5 * sqrt(3.0) * (m.ior - 1.0) * p.clear_alpha;
    p.clear_alpha = max(clear_alpha, MIN_PERCEPTUAL_ROUGHNESS * MIN_PERCEPTUAL_ROUGHNESS);
    vec3 entering = refract(-p.v, p.n, 1.0 / m.ior);
#if SUBSURFACE
    vec3 turned = v_interior.w * (entering - dot(entering, p.n) * p.n);
    vec3 leaving = refract(entering, -normalize(normalize(v_other_side) + turned), m.ior);
#else
    float curved = curvature(p.n_geometric, v_position);
    vec3 leaving = leaving_direction(p.n_geometric, curved, entering, m.thickness, m.ior);
    p.clear *= exp(-u_absorption * m.thickness);
#endif
    p.bent = -p.v - leaving;
    p.clear *= dot(leaving, leaving); // 0: all is reflected inside
#endif
}
