// What trace/track.frag has found: the distance to the path's collision in a volume, NO_COLLISION if there is none; the
// number of the volume.
#include "media/no_collision.glsl"

uniform sampler2D u_flight;
