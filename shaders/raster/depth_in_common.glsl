// How much of what hides two directions from a place on a fibre is the same, of others that fill the share `filled` of
// space, as an optical depth. Parallel fibres of radius r hide the directions that lie in two strips of width 2 r. None
// lies in the circle of radius r about the place, which would be inside of it. For the angle phi between the strips,
// these have the area r^2 / tan(phi / 2) in common, and one has the sector r^2 phi / 2 more in common with the circle.
// In that are r^2 (1 / tan(phi / 2) + phi / 2) filled / (pi r^2) fibres. y and z are the sine and cosine of phi, times
// the same.
#include "bsdf/constants.glsl"

float depth_in_common(float filled, float y, float z) {
    return filled * INV_PI * ((length(vec2(y, z)) + z) / max(abs(y), 1e-4) + 0.5 * atan(abs(y), z));
}
