// Masking and shadowing of V-shaped grooves (Torrance & Sparrow 1967; Cook & Torrance 1982, eq. 2), and no masking.

// V = G2 / (4 NoV NoL), G2 = min(1, 2 NoH NoV / VoH, 2 NoH NoL / VoH). It is brighter than Smith's, and has kinks.
float v_cavity(float NoV, float NoL, float NoH, float VoH) {
    float g = min(1.0, 2.0 * NoH * min(NoV, NoL) / max(VoH, 1e-6));
    return 0.25 * g / (NoV * NoL);
}

// G2 = 1: V = 1 / (4 NoV NoL)
float v_none(float NoV, float NoL) {
    return 0.25 / (NoV * NoL);
}
