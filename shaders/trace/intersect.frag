// What rays meet where nothing is see-through.
#include "trace/intersect.glsl"
