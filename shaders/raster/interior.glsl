// Light that a solid's medium scatters, as its surface shows it: the share of what enters that comes out on the same
// side of the solid, and on the other. viewer/bake/interior.py has the theory and the coefficients.
//
// A solid is a slab of the thickness d, or a ball of radius 3/2 d, or something between: d is half of the mean length
// of chords from the point, which are 2 d in a slab, and 4/3 of the radius in a ball, whatever the absorption. Light is
// told apart by its harmonics about the solid, up to the second: what is alike on all sides (`mean`), what has opposite
// signs on two sides (`odd`), and what is alike on these and weaker between them (`even`). Their ratios of flux to
// fluence are
//   slab  k tanh(k d / 2),  k coth(k d / 2),  k tanh(k d / 2)
//   ball  k (coth z - 1 / z),  k coth z,  k (2 / z + i3(z) / i2(z)),  z = k 3/2 d
// with i3 / i2 of spherical Bessel functions by Amos's bound z / (7/2 + sqrt(z^2 + 49/4)). A sun, whose light on a ball
// is max(cos, 0) = 1/4 + cos / 2 + (|cos| / 2 - 1/4), has all three.
// Light that is scattered only once does not feel how a surface is bent, so the callers multiply the share of the ball
// by the albedo: then random walks in balls agree to a few per cent.
const float LEAST_THICKNESS = 1e-6;

// z coth z - 1, also of small z
vec3 z_coth_less_1(vec3 z) {
    vec3 small = min(z, 0.3), z2 = small * small;
    vec3 series = z2 / 3.0 * (1.0 - z2 / 15.0 * (1.0 - z2 * (2.0 / 21.0)));
    return mix(z / tanh(clamp(z, 0.1, 20.0)) - 1.0, series, lessThan(z, vec3(0.3)));
}

// A solid at one point
struct Interior {
    vec3 mean, odd, even;       // ratios of flux to fluence, times h
    float entered;              // c below
    vec3 unscattered, straight; // e^-tau of the way through; e^-tau' where what goes straight on is unscattered, too
};

// k and h are per and in the unit of the thickness; `through` is the optical depth of the way through the solid, and
// `reduced` the part of it that turns light aside. `entered` is c = n^2 (1 - (1 - 1 / n^2)^(3/2)), by which light that
// a boundary of index n lets in goes deeper than what comes from everywhere.
Interior interior_of(vec3 k, vec3 h, float entered, float thickness, vec3 roundness, vec3 through, vec3 reduced) {
    float d = max(thickness, LEAST_THICKNESS);
    vec3 slab = z_coth_less_1(0.5 * k * d), ball = z_coth_less_1(1.5 * k * d), z2 = 2.25 * k * k * d * d;
    // tanh z = z / (z coth z); k (coth z - 1 / z) = (z coth z - 1) / (3/2 d)
    vec3 of_slab = 0.5 * d * k * k / (1.0 + slab);
    Interior inside;
    inside.mean = min(h * mix(of_slab, ball / (1.5 * d), roundness), 1.0);
    inside.odd = h * mix((1.0 + slab) / (0.5 * d), (1.0 + ball) / (1.5 * d), roundness);
    inside.even = h * mix(of_slab, (2.0 + z2 / (3.5 + sqrt(z2 + 12.25))) / (1.5 * d), roundness);
    inside.entered = entered;
    inside.unscattered = exp(-through);
    inside.straight = exp(-reduced);
    return inside;
}

// The share of one harmonic of the entering light that comes out again and has been scattered, where the boundary
// reflects the share `reflected` of what arrives from inside. Light that has the ratio x everywhere comes out as
// (1 - x) / (1 + x): it starts at the depth h. What is scattered for the first time at the mean depth c h starts as
// 1 - c x; but in a half-space, where all harmonics have the ratio of the mean, h is exact for what enters there.
// Of light that crosses a thin solid, only what is scattered on its way starts anywhere, which leaves
//   q = int_0^tau' t e^-t dt = 1 - (1 + tau') e^-tau'
// of its depth. Light that is scattered straight on comes out on the other side (`sign` -1: with the opposite sign).
vec3 scattered_share(vec3 x, float sign, Interior inside, vec3 reflected) {
    vec3 v = inside.straight, q = 1.0 - (1.0 - log(max(v, 1e-30))) * v;
    vec3 begun = 1.0 - v + sign * (v - inside.unscattered);
    vec3 left = begun - q * (inside.mean + inside.entered * (x - inside.mean));
    return (1.0 - reflected) * left / (1.0 + x - reflected * (1.0 - x));
}

// The shares of light of all harmonics that come out on its own side and on the other, and what the share of the mean
// has beyond both, RGB. The sum of all three is not negative where light arrives. Unscattered light is left out; it is
// seen through the solid.
void leaving_light(Interior inside, vec3 reflected, out vec3 own, out vec3 other, out vec3 everywhere) {
    vec3 mean = max(scattered_share(inside.mean, 1.0, inside, reflected), 0.0);
    vec3 even = clamp(scattered_share(inside.even, 1.0, inside, reflected), vec3(0.0), mean);
    vec3 most = 0.5 * (mean + even);
    vec3 odd = clamp(scattered_share(inside.odd, -1.0, inside, reflected), -most, most);
    own = 0.5 * (even + odd);
    other = 0.5 * (even - odd);
    everywhere = mean - even;
}
