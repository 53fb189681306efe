// How far the few rays of a pixel and its neighbours speak for all that a rough surface reflects.

// For the light of what they meet: less and less where the lobe is as wide as the hemisphere.
float share_of_light(float perceptual_roughness) {
    return 1.0 - smoothstep(0.8, 1.0, perceptual_roughness);
}

// For how much of the environment that hides, where many shadows tell it too: while the lobe is narrow.
float share_of_shadow(float perceptual_roughness) {
#if VISIBILITY
    return 1.0 - smoothstep(0.15, 0.4, perceptual_roughness);
#else
    return share_of_light(perceptual_roughness);
#endif
}
