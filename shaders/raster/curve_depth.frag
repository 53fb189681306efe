// Depth of curves: for shadow maps, and before they are shaded, so that each sample is shaded once.
#include "raster/curve_coverage.glsl"

void main() {
    if (!is_covered()) discard;
}
