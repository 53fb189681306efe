// Indirect light from other surfaces, path traced at the vertices beforehand (viewer/trace/vertex_light.py).
in vec4 v_indirect; // irradiance / pi; part of the hemisphere that other surfaces cover

// We add it to the diffuse base only. Using the hemispherical mean for specular reflection too made pictures worse
// (docs/choices.md). Without the visibility pass, the covered part of the hemisphere occludes the environment.
void add_indirect(float NoV, float alpha, inout mat2x3 specular, inout vec3 mean_light) {
    // It was gathered about the front of the surface, so the back gets none. With multisampling a pixel's centre may
    // lie outside the triangle, where interpolation extrapolates: hence the clamp.
    vec4 indirect = gl_FrontFacing ? clamp(v_indirect, vec4(0.0), vec4(vec3(65504.0), 1.0)) : vec4(0.0);
#if !VISIBILITY
    float sky_visibility = 1.0 - indirect.a;
    specular *= specular_occlusion(NoV, sky_visibility, alpha);
    mean_light *= sky_visibility;
#endif
    mean_light += indirect.rgb;
}
