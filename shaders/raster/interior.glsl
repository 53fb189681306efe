// Light that a solid's medium scatters, as its surface shows it: the share of what enters that comes out on the same
// side of the solid, and on the other. viewer/bake/interior.py has the theory and the coefficients.
//
// A solid is a slab of the thickness d, or a ball of radius 3/2 d, or something between: d is half of the mean length
// of chords from the point, which are 2 d in a slab, and 4/3 of the radius in a ball, whatever the absorption. Light
// that is alike on all sides (x of `even`) and light of opposite sign on two sides (`odd`) have a ratio of flux to
// fluence of
//   slab  k tanh(k d / 2),  k coth(k d / 2)        ball  k (coth z - 1 / z),  k coth z,  z = k 3/2 d
// Light that is scattered only once does not feel how a surface is bent, so the callers multiply the share of the ball
// by the albedo: then random walks in balls agree to a few per cent.
const float LEAST_THICKNESS = 1e-6;

// z coth z - 1, also of small z
vec3 z_coth_less_1(vec3 z) {
    vec3 small = min(z, 0.3), z2 = small * small;
    vec3 series = z2 / 3.0 * (1.0 - z2 / 15.0 * (1.0 - z2 * (2.0 / 21.0)));
    return mix(z / tanh(clamp(z, 0.1, 20.0)) - 1.0, series, lessThan(z, vec3(0.3)));
}

// A solid at one point: of the light that arrives at its inner side, R is reflected and T passes.
struct Interior {
    vec3 even, odd;   // R + T and R - T
    vec3 unscattered; // the part of T that has met nothing
};

// k and h are per and in the unit of the thickness; `unscattered` is e^-tau along the ray that is seen through the
// solid.
Interior interior_of(vec3 k, vec3 h, float thickness, vec3 roundness, vec3 unscattered) {
    float d = max(thickness, LEAST_THICKNESS);
    vec3 slab = z_coth_less_1(0.5 * k * d), ball = z_coth_less_1(1.5 * k * d);
    // tanh z = z / (z coth z); k (coth z - 1 / z) = (z coth z - 1) / (3/2 d)
    vec3 x = h * mix(0.5 * d * k * k / (1.0 + slab), ball / (1.5 * d), roundness);
    vec3 y = h * mix((1.0 + slab) / (0.5 * d), (1.0 + ball) / (1.5 * d), roundness);
    Interior inside;
    inside.even = (1.0 - min(x, 1.0)) / (1.0 + min(x, 1.0));
    inside.odd = (1.0 - y) / (1.0 + y);
    inside.unscattered = min(unscattered, 0.5 * (inside.even - inside.odd));
    return inside;
}

// The shares of the entering light that come out on its own side and on the other, where the boundary reflects the
// share `reflected` of what arrives from inside, RGB. Unscattered light is left out; it is seen through the solid.
void leaving_light(Interior inside, vec3 reflected, out vec3 own, out vec3 other) {
    vec3 even = (1.0 - reflected) * max(inside.even - inside.unscattered, 0.0) / (1.0 - reflected * inside.even);
    vec3 odd = (1.0 - reflected) * (inside.odd + inside.unscattered) / (1.0 - reflected * inside.odd);
    odd = clamp(odd, -even, even);
    own = 0.5 * (even + odd);
    other = 0.5 * (even - odd);
}
