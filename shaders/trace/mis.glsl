// The weight of a direction that was sampled with density p, where the other technique has the density q for it.
// Balance heuristic of Veach & Guibas 1995, "Optimally Combining Sampling Techniques", which is what the density of
// light samples is made for (Karlik et al. 2019, "MIS Compensation"; viewer/trace/scene/environment.py). The power
// heuristic has more variance (benchmarks/results/trace_variance.md).
float mis_weight(float p, float q) {
    return 1.0 / (1.0 + q / p);
}

// The weights of light that a BSDF sample hit and of light that was sampled itself. SAMPLING: 0 combines both
// techniques, 1 uses BSDF samples alone, 2 light samples alone.
float bsdf_weight(float bsdf_pdf, float light_pdf) {
    return SAMPLING == 0 ? mis_weight(bsdf_pdf, light_pdf) : float(SAMPLING == 1);
}

float light_weight(float light_pdf, float bsdf_pdf) {
    return SAMPLING == 0 ? mis_weight(light_pdf, bsdf_pdf) : float(SAMPLING == 2);
}
