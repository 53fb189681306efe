// Numbers every model shares.
const float PI = 3.14159265358979;
const float INV_PI = 0.318309886183791;

// Real-time roughness floor. D(0) = 1 / (pi alpha^2) leaves a half float's range at perceptual roughness 0.047, and a
// point light's highlight would be smaller than any pixel.
const float MIN_PERCEPTUAL_ROUGHNESS = 0.045;
