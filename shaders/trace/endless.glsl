// Paths of very many collisions, in media that absorb next to nothing, end all the same: the mean free path grows.
// Where a walk has been for n collisions it has come about sqrt(n) mean free paths far, and while that grows by a
// factor, so may the mean free path. Where light leaves a white medium does not depend on it but near the boundary.

// The extinction of a path's media over what it was at first
float extinction_left(Path p) {
    return exp2(-float(max(p.steps - THINS_FROM, 0)) / float(THINS_EVERY));
}

// The medium that the path travels in, as it finds it
Medium medium_around(Path p) {
    Medium m = medium_of(innermost(p.medium));
    m.sigma_t *= extinction_left(p);
    return m;
}
