// Intersections in scenes where shadow rays may pass see-through surfaces.
#include "trace/intersect.glsl"
#include "trace/see_through.glsl"
