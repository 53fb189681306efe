// What raster/choose.frag stores of a pixel's first and second surface: the number of a triangle (raster/planes.glsl),
// 0 for the background, and in the last four bits the samples that show it.
const int SAMPLES_BIT = 28;

uvec2 chosen_numbers(uvec2 chosen) {
    return chosen & ((1u << SAMPLES_BIT) - 1u);
}

uvec2 chosen_samples(uvec2 chosen) {
    return chosen >> SAMPLES_BIT;
}
