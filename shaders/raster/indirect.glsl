// Light from other surfaces, found at the vertices beforehand (viewer/trace/vertex_light.py).
in vec4 v_indirect; // irradiance over pi; how much of the hemisphere they cover

// Adds it to what falls on the base. What they hide of the environment is known (VISIBILITY) or guessed from how much
// of the hemisphere they cover. What is mirrored of them no mean over it tells: in its place it made pictures worse.
void add_indirect(float NoV, float alpha, inout mat2x3 specular, inout vec3 mean_light) {
    // It is about the normal as given; outside its triangle, where a pixel may have its middle, it may leave its range.
    vec4 indirect = gl_FrontFacing ? clamp(v_indirect, vec4(0.0), vec4(vec3(65504.0), 1.0)) : vec4(0.0);
#if !VISIBILITY
    float open = 1.0 - indirect.a;
    specular *= specular_occlusion(NoV, open, alpha);
    mean_light *= open;
#endif
    mean_light += indirect.rgb;
}
