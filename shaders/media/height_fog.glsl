// Fog that thins out with height. Heights y are in scale heights above the base: the density is exp(-max(y, 0)),
// relative to that of the base and below. tests/trace/test_fog_ways.py has both functions in float64.
#include "media/one_minus_exp.glsl"
#include "media/no_collision.glsl"

// The mean density of a straight way between two heights
float mean_density(float y0, float y1) {
    float low = min(y0, y1), high = max(y0, y1);
    float below = clamp(-low / max(high - low, 1e-20), 0.0, 1.0); // share of the way below the base
    if (high <= 0.0) return 1.0;
    low = max(low, 0.0);
    float x = high - low;
    return below + (1.0 - below) * exp(-low) * (x > 1e-4 ? one_minus_exp(x) / x : 1.0 - 0.5 * x);
}

// As distance_to_dense, while the way stays above the base: exp(-y) (1 - exp(-k t)) / k = s, solved for t
float distance_above(float y, float k, float s) {
    float level = s * exp(min(y, 85.0)); // the distance if the way were level
    float a = k * level;
    if (a >= 1.0) return NO_COLLISION; // all fog ahead is thinner than that
    if (a < -1.0) return (y + log(exp(-y) - k * s)) / -k;
    return level * (abs(a) > 1e-4 ? minus_log_one_minus(a) / a : 1.0 + 0.5 * a);
}

// The distance over which a way has the same optical depth as one of length s at the density 1. It begins at the height
// y and rises by k scale heights a unit of length.
float distance_to_dense(float y, float k, float s) {
    if (y >= 0.0 && k < 0.0) { // down to the base, and on below it
        float above = one_minus_exp(y) / -k;
        return s <= above ? distance_above(y, k, s) : y / -k + (s - above);
    }
    if (y >= 0.0) return distance_above(y, k, s);
    if (s * k <= -y) return s;
    return -y / k + distance_above(0.0, k, s + y / k);
}
