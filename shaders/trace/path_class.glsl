// The class of a path, a number of viewer/trace/kinds.py, is stored as a depth value.

// Exact in every depth format
float class_depth(int path_class) {
    return float(path_class) / 16.0;
}
