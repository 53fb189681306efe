// Weight of a direction taken with density p where another technique would have taken it with q.
// Power heuristic of Veach & Guibas 1995, "Optimally Combining Sampling Techniques": p^2 / (p^2 + q^2), by the ratio so
// that neither square leaves float32's range.
float mis_weight(float p, float q) {
    float ratio = q / p;
    return 1.0 / (1.0 + ratio * ratio);
}
