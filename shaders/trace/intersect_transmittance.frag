// Intersections in scenes where shadow rays may pass boundaries between media, thin smooth panes and see-through
// surfaces.
#include "trace/intersect.glsl"
#include "trace/see_through.glsl"
#include "trace/shadow_transmittance.glsl"
