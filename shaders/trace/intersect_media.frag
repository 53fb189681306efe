// Intersections in scenes with scattering, where shadow rays may pass boundaries between media and see-through surfaces.
#include "trace/intersect.glsl"
#include "trace/see_through.glsl"
#include "trace/shadow_media.glsl"
