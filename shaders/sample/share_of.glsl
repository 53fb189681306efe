// part / (part + rest) for numbers >= 0, or 0 without a part. No more than 1, also where a driver's division is not
// exact: 1 - share would be negative, and with it a density.
float share_of(float part, float rest) {
    return part > 0.0 ? min(part / (part + rest), 1.0) : 0.0;
}
