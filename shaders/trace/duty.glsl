// What there is to do in a slot is its class, a number of viewer/trace/kinds.py; it is passed on as a depth.

// Exact in whatever format a depth is kept
float duty_depth(int duty) {
    return float(duty) / 16.0;
}
