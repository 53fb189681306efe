// The media where nothing stands behind them; the background of the picture shows through.
#include "raster/in_media.glsl"

out vec4 o_color; // associated alpha

void main() {
    Haze haze = haze_at(1e18);
#if HALF_TARGET
    haze.light = min(haze.light, vec3(65504.0));
#endif
    o_color = vec4(haze.light, 1.0 - haze.transmittance);
}
