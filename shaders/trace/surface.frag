// Opaque surfaces: the layered BSDF of bsdf/surface.glsl.
#define TRANSMITS 0
#define REFRACTS 0
#include "trace/layered.glsl"
