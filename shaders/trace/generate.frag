// Paths begin at a camera or at a surface.
#define LIT 0
#include "trace/generate.glsl"
