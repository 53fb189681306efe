// What rays meet where shadow rays may go through some of it.
#include "trace/intersect.glsl"
#include "trace/see_through.glsl"
