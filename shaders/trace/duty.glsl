// What there is to do in a slot (viewer/trace/paths/passes.py): nothing, end a path and begin the next, note what the camera
// sees first, shade a surface of kind 0, 1, ...
const int REST = 0, FINISH = 1, FIRST_HIT = 2, SHADE = 3;

// Exact in whatever format a depth is kept
float duty_depth(int duty) {
    return float(duty) / 16.0;
}
