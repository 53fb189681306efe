// What the diffuse base of surface.glsl lets through to the other side (KHR_materials_diffuse_transmission). The
// interface dims it for both directions, as it does what is reflected. surface.glsl includes this file.

// f of the base for light from the other side; dfg_light = (a, b) of the split sum for |NoL|
vec3 surface_transmission(Surface s, SurfaceView v, vec2 dfg_light) {
    vec3 f = MIX_METAL(s, interface_throughput(v.dielectric, dfg_light) * f_lambert(transmitted_albedo(s)), vec3(0.0));
#if SHEEN
    f *= v.sheen.throughput; // fibres stand on the viewer's side
#endif
    return f;
}

// The fraction of uniform light from the other side that leaves the base towards the viewer
vec3 surface_transmitted(Surface s, SurfaceView v) {
    return MIX_METAL(s, interface_entering(v.dielectric, v.dfg) * transmitted_albedo(s), vec3(0.0));
}

// The probability that a sample of the diffuse part leaves on the other side
float below_probability(Surface s, SurfaceView v) {
    return share_of(luminance(surface_transmitted(s, v)), luminance(multiple_albedo(s, v)));
}

// base_eval_pdf for wi.z < 0; p_diffuse is the probability of the diffuse part.
vec4 transmission_eval_pdf(Surface s, SurfaceView v, vec3 wo, vec3 wi, float p_diffuse, sampler2D dfg) {
    if (wo.z <= 0.0) return vec4(0.0);
    vec3 f = surface_transmission(s, v, facet_albedo(s, vec3(wi.xy, -wi.z), v.perceptual_roughness, dfg));
    return vec4(f * -wi.z, p_diffuse * below_probability(s, v) * pdf_cosine_hemisphere(-wi));
}
