// How far one ray along the mirror direction speaks for all that a rough surface reflects: 1 where the lobe is narrower
// than what it sees of the model, 0 from TRACED_ROUGHNESS on (`viewer/plan.py` has no rays for surfaces as rough).
float mirror_share(float perceptual_roughness) {
    return 1.0 - smoothstep(0.5, 1.0, perceptual_roughness / 0.45);
}
