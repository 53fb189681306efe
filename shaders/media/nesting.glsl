// The media that a path is inside of, as digits of one whole number: the lowest digit is the medium that was entered
// last, the next one is what the path returns to when it leaves that, and so on. The path travels in that of the lowest
// digit: the inner one of nested solids displaces the outer one, and of two that overlap the one that was entered last
// does. In scenes with nested solids of glass (HAS_NESTED) it travels in that of the highest number. The base is the
// number of media. Beyond the digits that 24 bits can hold, the outermost are forgotten. The endless zeros in front are
// medium 0, the outside.
uniform int u_media_count;
uniform int u_nesting_limit; // the base to the power of the number of digits but one

int innermost(int nesting) {
#if HAS_NESTED
    // Where solids overlap, the one with the highest number displaces the others (viewer/trace/scene/nested.py).
    int highest = 0;
    for (int rest = nesting; rest > 0; rest /= u_media_count) highest = max(highest, rest % u_media_count);
    return highest;
#else
    return nesting % u_media_count;
#endif
}

int enter_medium(int nesting, int medium) {
    return nesting % u_nesting_limit * u_media_count + medium;
}

// Removes the innermost occurrence, wherever it is, since solids that overlap are not left in the order of entry.
int leave_medium(int nesting, int medium) {
    for (int place = 1; place <= u_nesting_limit; place *= u_media_count) {
        int outer = nesting / place;
        if (outer % u_media_count == medium) return outer / u_media_count * place + nesting % place;
        if (outer == 0) break;
    }
    return nesting;
}

int cross_boundary(int nesting, int medium, bool is_front) {
    return is_front ? enter_medium(nesting, medium) : leave_medium(nesting, medium);
}
