// Sheen: fibres that stand above a cloth (KHR_materials_sheen). With E the directional albedo of the lobe and c the
// largest channel of its colour, light passes the fibres with T(mu) = 1 - c E(mu):
//   f = colour * charlie + T(o) (interface + T(i) / N * base)
// The base, which scatters light to all sides, is dimmed for both directions: light that arrives at a grazing angle is
// not reflected twice. N makes a white cloth white: it is the mean of T over the light that reaches the base.
#include "bsdf/charlie.glsl"
#include "bsdf/layer/interface.glsl"
#include "light/dfg.glsl"

struct Sheen {
    vec3 color;
    float perceptual_roughness;
    float largest;     // channel of the colour
    float throughput;  // T(o)
    float mean;        // N
    vec3 albedo;       // color E(o)
};

float sheen_throughput(Sheen s, float mu) {
    return 1.0 - s.largest * min(charlie_albedo(mu, s.perceptual_roughness), 1.0);
}

Sheen make_sheen(vec3 color, float perceptual_roughness, float NoV) {
    Sheen s;
    s.color = color;
    s.perceptual_roughness = perceptual_roughness;
    s.largest = max3(color);
    s.throughput = sheen_throughput(s, NoV);
    s.albedo = color * min(charlie_albedo(NoV, perceptual_roughness), 1.0) * float(SHOW_SPECULAR);
    s.mean = 1.0;
    return s;
}

// N over the base below the interface `face`, whose table is read with `roughness`: Gauss quadrature of
//   N = int T T_face mu dmu / int T_face mu dmu
float sheen_mean(Sheen s, Interface face, float roughness, sampler2D dfg) {
    const vec4 mu = vec4(0.06943184, 0.33000948, 0.66999052, 0.93056816);
    const vec4 weight = vec4(0.0241522, 0.2152141, 0.4369311, 0.3237026);
    vec2 sums = vec2(0.0);
    for (int k = 0; k < 4; ++k) {
        float passed = weight[k] * interface_transmittance(face, dfg_albedo(dfg, mu[k], roughness));
        sums += passed * vec2(sheen_throughput(s, mu[k]), 1.0);
    }
    return sums.y > 1e-6 ? sums.x / sums.y : 1.0; // no light reaches the base of a perfect mirror
}

vec3 sheen_response(Sheen s, float NoV, float NoL, float s2) {
    return s.color * (charlie(NoV, NoL, s2, s.perceptual_roughness) * float(SHOW_SPECULAR));
}

vec3 sheen_over(Sheen s, vec3 sheen, vec3 below) {
    return sheen + s.throughput * below;
}

// The axis of the cosine lobe that stands for the sheen under an environment. Fibres send light back: the mean direction
// leans from n towards the viewer. By quadrature, its slope is (0.27 r^-1.2 - 0.09)(0.75 + 1.1 NoV), but for views along
// the normal, and the lobe is about as wide as that of the cosine.
vec3 sheen_axis(Sheen s, vec3 n, vec3 v, float NoV) {
    float r = clamp(s.perceptual_roughness, CHARLIE_SMOOTHEST, 1.0);
    float slope = (0.27 * pow(r, -1.2) - 0.09) * (0.75 + 1.1 * NoV);
    vec3 tangent = v - NoV * n;
    float sine = length(tangent);
    return normalize(n + tangent * (slope * min(4.0 * sine, 1.0) / max(sine, 1e-4)));
}
