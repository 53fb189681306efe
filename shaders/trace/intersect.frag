// Intersections in scenes without see-through surfaces.
#include "trace/intersect.glsl"
