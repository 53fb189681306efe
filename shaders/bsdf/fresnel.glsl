// Fresnel reflectance F(mu), mu = cosine between the direction and the (micro)normal.

float pow5(float x) {
    float x2 = x * x;
    return x2 * x2 * x;
}

// F = f0 + (f90 - f0) (1 - mu)^5                      Schlick 1994, "An inexpensive BRDF model", eq. 15
vec3 f_schlick(vec3 f0, vec3 f90, float mu) {
    return f0 + (f90 - f0) * pow5(clamp(1.0 - mu, 0.0, 1.0));
}

// Mean of Schlick's F over the hemisphere, 2 int F mu dmu = f0 + (f90 - f0) / 21
vec3 f_schlick_mean(vec3 f0, vec3 f90) {
    return f0 + (f90 - f0) / 21.0;
}

// Unpolarised reflectance of a smooth dielectric, eta = index beyond / index before, mu >= 0.
//   delta = (eta - 1)(eta + 1),  g^2 = delta + mu^2   (g^2 < 0: total internal reflection)
//   r_s = -delta / (mu + g)^2,   r_p = delta ((eta^2 + 1) mu^2 - 1) / (eta^2 mu + g)^2,   F = (r_s^2 + r_p^2) / 2
// These are Fresnel's equations with the difference of the indices factored out of each numerator. So eta = 1 gives
// exactly 0, and eta close to 1 is precise (the textbook form subtracts nearly equal numbers).
float f_dielectric(float mu, float eta) {
    float delta = (eta - 1.0) * (eta + 1.0);
    float g2 = delta + mu * mu;
    if (g2 < 0.0) return 1.0;
    float g = sqrt(g2);
    float sum_s = mu + g;
    if (sum_s <= 0.0) return delta == 0.0 ? 0.0 : 1.0; // at grazing angles: 0 for eta = 1, else 1
    float sum_p = eta * eta * mu + g;
    float r_s = delta / (sum_s * sum_s);
    float r_p = delta * ((eta * eta + 1.0) * mu * mu - 1.0) / (sum_p * sum_p);
    return 0.5 * (r_s * r_s + r_p * r_p);
}

// f0 = ((eta - 1) / (eta + 1))^2
float f0_from_eta(float eta) {
    float r = (eta - 1.0) / (eta + 1.0);
    return r * r;
}
