// Phong's and Blinn's highlights, normalised so that lobes of any width reflect about the same amount of light.
#include "bsdf/constants.glsl"

// f = (s + 2) / (2 pi) max(r.v, 0)^s, r the light mirrored at n   (Phong 1975; Lafortune & Willems 1994)
float f_phong(float RoV, float shininess) {
    return RoV > 0.0 ? (shininess + 2.0) * 0.5 * INV_PI * pow(RoV, shininess) : 0.0;
}

// f = (s + 8) / (8 pi) max(n.h, 0)^s   (Blinn 1977; normalisation as in Akenine-Moller et al., "Real-Time Rendering")
float f_blinn(float NoH, float shininess) {
    return NoH > 0.0 ? (shininess + 8.0) * 0.125 * INV_PI * pow(NoH, shininess) : 0.0;
}
