// Low-discrepancy points in the unit square, for integrals of smooth functions with a fixed number of points.

// Point i of n of the Hammersley set (Hammersley 1960): (i + 1/2) / n, and i with its bits mirrored at the binary
// point.
vec2 hammersley(uint i, uint n) {
    uint bits = (i << 16u) | (i >> 16u);
    bits = ((bits & 0x55555555u) << 1u) | ((bits & 0xAAAAAAAAu) >> 1u);
    bits = ((bits & 0x33333333u) << 2u) | ((bits & 0xCCCCCCCCu) >> 2u);
    bits = ((bits & 0x0F0F0F0Fu) << 4u) | ((bits & 0xF0F0F0F0u) >> 4u);
    bits = ((bits & 0x00FF00FFu) << 8u) | ((bits & 0xFF00FF00u) >> 8u);
    return vec2((float(i) + 0.5) / float(n), (float(bits >> 8u) + 0.5) / 16777216.0); // 24 bits: below 1 in float32
}
