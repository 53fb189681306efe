// The class of a path, a number of viewer/trace/layout.py, is stored as a depth value.

// Sixteenths are exact in float32, and so are the depth of a vertex, -1 to 1, and its map to 0 to 1. In a depth buffer
// of floats nothing is rounded, so what is written and what is compared with it are equal to the bit. In one of 24
// bits, whose steps are 1 / (2^24 - 1), they would be rounded, perhaps by different units of a device.
float class_depth(int path_class) {
    return float(path_class) / 16.0;
}
