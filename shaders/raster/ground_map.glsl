// The places of points of the ground in its map, along one axis: x is in radii of the scene from its middle, s from -1
// to 1. Half of the map is for a square of two radii; beyond, texels grow as the square of the distance, up to infinity.
// Value and slope are continuous.

float to_map(float x) {
    return abs(x) < 1.0 ? 0.5 * x : sign(x) - 0.5 / x;
}

float from_map(float s) {
    return abs(s) < 0.5 ? 2.0 * s : 0.5 / (sign(s) - s);
}
