// Visibility of the specular lobe from that of the hemisphere. Lagarde & de Rousiers 2014, "Moving Frostbite to
// Physically Based Rendering", p. 76
float specular_occlusion(float NoV, float occlusion, float alpha) {
    return clamp(pow(NoV + occlusion, exp2(-16.0 * alpha - 1.0)) - 1.0 + occlusion, 0.0, 1.0);
}
