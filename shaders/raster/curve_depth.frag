// Depth of curves: for shadow maps, and before they are shaded, so that each sample is shaded once.
#include "raster/curve_point.glsl"

void main() {
#if ROUND == 2
    CurvePoint at;
    if (!curve_point(at)) discard;
#else
    if (!is_covered()) discard;
#endif
}
