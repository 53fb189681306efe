// The phase function of fog and clouds: droplets of water, 5 to 50 micrometres in diameter. It is a mixture of a lobe
// by Henyey & Greenstein and one by Draine 2003, fitted to Mie's solution: Jendersie & d'Eon 2023, "An Approximate Mie
// Scattering Function for Fog and Cloud Rendering".
#include "media/phase.glsl"

struct Droplets {
    float g;      // of the lobe by Henyey & Greenstein
    float g_wide; // of Draine's lobe
    float a;      // its alpha
    float share;  // the weight of Draine's lobe, which is also the probability of sampling it
};

// The fit for a diameter in micrometres (ibid., section 3)
Droplets droplets(float diameter) {
    float d = clamp(diameter, 5.0, 50.0);
    return Droplets(exp(-0.0990567 / (d - 1.67154)),
                    exp(-2.20679 / (d + 3.91029) - 0.428934),
                    exp(3.62489 - 8.29288 / (d + 5.52825)),
                    exp(-0.599085 / (d - 0.641583) - 0.665888));
}

// Draine's lobe: that of Henyey & Greenstein times (1 + a mu^2) / n, with x = 1 - mu
float draine_norm(Droplets m) {
    return 1.0 + m.a * (1.0 + 2.0 * m.g_wide * m.g_wide) / 3.0;
}

float draine(Droplets m, float x) {
    float mu = 1.0 - x;
    return henyey_greenstein(m.g_wide, x) * (1.0 + m.a * mu * mu) / draine_norm(m);
}

float droplets_between(Droplets m, vec3 before, vec3 after) {
    float x = one_minus_cosine(before, after);
    return mix(henyey_greenstein(m.g, x), draine(m, x), m.share);
}

// Samples 1 - mu of Draine's lobe. In t = sqrt(1 + g^2 - 2 g mu), which goes from 1 - g to 1 + g, its density is
//   (1 - g^2) / (2 g n t^2) (1 + a mu^2),  mu = (1 + g^2 - t^2) / 2 g
// The integral has a closed form; with s = 1 + g^2 and b = a / 4 g^2 it is, up to a factor,
//   b t^3 / 3 - 2 b s t - (1 + b s^2) / t
// Newton's steps invert it. A step that leaves the bracket is replaced by its middle.
float draine_integral(float t, float s, float b) {
    return t * b * (t * t / 3.0 - 2.0 * s) - (1.0 + b * s * s) / t;
}

float draine_sample(Droplets m, float u) {
    float g = m.g_wide, s = 1.0 + g * g;
    float b = m.a / (4.0 * g * g);
    float scale = (1.0 - g * g) / (2.0 * g * draine_norm(m));
    float low = 1.0 - g, high = 1.0 + g;
    float at_low = draine_integral(low, s, b);
    float t = (1.0 - g * g) / (1.0 + g - 2.0 * g * u); // for a = 0
    for (int k = 0; k < 12; ++k) {
        float mu = (s - t * t) / (2.0 * g);
        float error = scale * (draine_integral(t, s, b) - at_low) - u;
        if (error > 0.0) high = t;
        else low = t;
        float next = t - error * t * t / (scale * (1.0 + m.a * mu * mu));
        if (abs(next - t) <= 1e-6 * t) break; // what rounding leaves of the error
        t = next > low && next < high ? next : 0.5 * (low + high);
    }
    return max((t - (1.0 - g)) * (t + (1.0 - g)) / (2.0 * g), 0.0);
}

// Samples droplets_between about the direction of travel; u in [0, 1)^2.
vec3 droplets_sample(Droplets m, vec3 direction, vec2 u) {
    if (u.x >= m.share) return phase_sample(m.g, direction, vec2((u.x - m.share) / (1.0 - m.share), u.y));
    float x = min(draine_sample(m, u.x / m.share), 2.0);
    return direction_about(direction, x, sqrt(x * (2.0 - x)), u.y);
}
