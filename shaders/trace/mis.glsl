// Weight of a direction taken with density p where another technique would have taken it with q.
// Power heuristic of Veach & Guibas 1995, "Optimally Combining Sampling Techniques": p^2 / (p^2 + q^2), by the ratio so
// that neither square leaves float32's range.
float mis_weight(float p, float q) {
    float ratio = q / p;
    return 1.0 / (1.0 + ratio * ratio);
}

// Of light that a direction chosen by the BSDF met, and of light that was chosen itself. SAMPLING: 0 both count, 1 the
// first alone, 2 the second alone, to show what each is good for.
float bsdf_weight(float bsdf_pdf, float light_pdf) {
    return SAMPLING == 0 ? mis_weight(bsdf_pdf, light_pdf) : float(SAMPLING == 1);
}

float light_weight(float light_pdf, float bsdf_pdf) {
    return SAMPLING == 0 ? mis_weight(light_pdf, bsdf_pdf) : float(SAMPLING == 2);
}
