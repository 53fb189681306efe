// 1 - cos of the angle between two directions of length 1. The dot product would lose the digits of small angles, where
// narrow cones and forward peaks are: |a - b|^2 = 2 (1 - cos).
float one_minus_cosine(vec3 a, vec3 b) {
    vec3 difference = a - b;
    return 0.5 * dot(difference, difference);
}
