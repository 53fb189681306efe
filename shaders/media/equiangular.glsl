// Points of a ray at equal angles as a light sees them. The density is in proportion to 1 / distance^2 to the light, so
// that what a point light scatters along a ray has little variance. Kulla & Fajardo 2012, "Importance Sampling
// Techniques for Path Tracing in Participating Media", section 5.1.

// atan(y, x); the built-in function of some drivers loses digits of a small angle.
float angle_of(float y, float x) {
    float ratio = y / x;
    if (!(x > 0.0 && ratio < 0.1)) return atan(y, x);
    float r2 = ratio * ratio;
    return ratio * (1.0 - r2 * (1.0 / 3.0 - r2 * (0.2 - r2 / 7.0)));
}

// sin(x); that of some GPUs has an absolute error of 1e-7, all digits of a small angle.
float sine_of(float x) {
    float x2 = x * x;
    return abs(x) < 0.1 ? x * (1.0 - x2 * (1.0 / 6.0 - x2 * (1.0 / 120.0 - x2 / 5040.0))) : sin(x);
}

struct Equiangular {
    float closest; // distance from the light to the line of the ray, D
    float start;   // of the ray, from its point that is closest to the light, a
    float angle;   // under which the light sees the ray
};

// Of a ray up to the distance `limit`. A light on the ray has D = 0 and no density; D is kept above 1e-5 of the limit.
Equiangular equiangular(vec3 origin, vec3 direction, float limit, vec3 light) {
    float along = dot(light - origin, direction);
    Equiangular e;
    e.closest = max(length(light - origin - along * direction), 1e-5 * limit);
    e.start = -along;
    // atan(b / D) - atan(a / D), which cancels for a distant light, with b = a + limit
    e.angle = angle_of(e.closest * limit, e.closest * e.closest + e.start * (e.start + limit));
    return e;
}

// The distance along the ray. The paper's D tan(theta) is counted from the point closest to the light. The difference
// of two tangents is counted from the start, and keeps the digits of a distant light:
//   D (tan(theta + x) - tan(theta)) = (D^2 + a^2) sin x / (D cos x - a sin x)
float equiangular_sample(Equiangular e, float limit, float u) {
    float x = u * e.angle;
    float sine = sine_of(x), below = e.closest * cos(x) - e.start * sine;
    return below > 0.0 ? min((e.closest * e.closest + e.start * e.start) * sine / below, limit) : limit;
}

float equiangular_pdf(Equiangular e, float distance) {
    float t = e.start + distance;
    return e.closest / (e.angle * (e.closest * e.closest + t * t));
}
