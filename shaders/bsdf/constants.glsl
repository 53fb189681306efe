// Constants that all shading models share.
const float PI = 3.14159265358979;
const float INV_PI = 0.318309886183791;

// The minimum roughness of the raster's lobes under lights. At perceptual roughness 0.047 the peak
// D(0) = 1 / (pi alpha^2) reaches the maximum of a half float, and a point light's highlight is smaller than a pixel.
const float MIN_PERCEPTUAL_ROUGHNESS = 0.045;
