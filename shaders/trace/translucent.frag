// Surfaces whose diffuse base lets light through: the layered BSDF of bsdf/surface.glsl, with a lobe on either side.
// The inside of a solid has the same index here as the outside, since the lobe hides what refraction would change.
#define TRANSMITS 1
#define REFRACTS 0
#include "trace/layered.glsl"
