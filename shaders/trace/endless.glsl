// Paths of very many collisions, in media that absorb next to nothing, end all the same: the mean free path grows.
// Where a walk has been for n collisions it has come about sqrt(n) mean free paths far, and while that grows by a
// factor, so may the mean free path. Where light leaves a white medium does not depend on it but near the boundary.

// How often the mean free path of a path has doubled. Before the last collision that it may have it hurries.
float doublings(Path p) {
    return float(max(p.steps - THINS_FROM, 0)) / float(THINS_EVERY)
         + float(max(p.steps - HURRIES_FROM, 0)) / float(HURRIES_EVERY);
}

// The extinction of a path's media over what it was at first
float extinction_left(Path p) {
    return exp2(-doublings(p));
}

// How many collisions of the media as they are one of the path's stands for: so many more bring a walk as far.
float collisions_each(Path p) {
    return exp2(min(2.0 * doublings(p), 80.0));
}

// What absorbs next to nothing absorbs at each of them: light decays as fast on its way as it did before.
vec3 albedo_left(vec3 albedo, Path p) {
    return max(albedo - (1.0 - albedo) * (collisions_each(p) - 1.0), 0.0);
}

// The medium that the path travels in, as it finds it
Medium medium_around(Path p) {
    Medium m = medium_of(innermost(p.medium));
    m.sigma_t *= extinction_left(p);
    m.albedo = albedo_left(m.albedo, p);
    return m;
}
