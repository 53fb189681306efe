// Texture coordinates of directions in equirectangular maps, to the precision of float32 even at the poles. Light
// samples and rays that leave the scene have to agree about the texel. light/equirect.glsl is the faster version, with
// an error of 1e-4 rad.
#include "bsdf/constants.glsl"

// atan2(y, x) in turns, -1/2 .. 1/2. Odd polynomial on |t| <= tan(pi / 8), error 2e-8 rad (Moshier, Cephes, atanf).
float turns_precisely(float y, float x) {
    float ax = abs(x), ay = abs(y);
    float low = min(ax, ay), high = max(max(ax, ay), 1e-30);
    bool is_steep = low > 0.41421356 * high;
    float t = is_steep ? (low - high) / (low + high) : low / high; // atan(t) = pi / 4 + atan((t - 1) / (t + 1))
    float t2 = t * t;
    float series = ((8.05374449538e-2 * t2 - 1.38776856032e-1) * t2 + 1.99777106478e-1) * t2 - 3.33329491539e-1;
    float a = t + t * t2 * series;
    a = a * (0.5 * INV_PI) + (is_steep ? 0.125 : 0.0);
    a = ay > ax ? 0.25 - a : a;
    a = x < 0.0 ? 0.5 - a : a;
    return y < 0.0 ? -a : a;
}

vec2 precise_equirect_uv(vec3 d) {
    return vec2(0.5 + turns_precisely(d.z, d.x), 2.0 * turns_precisely(length(d.xz), d.y));
}
