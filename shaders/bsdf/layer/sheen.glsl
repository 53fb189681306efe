// Sheen: fibres that stand above a cloth (KHR_materials_sheen). With E the directional albedo of the lobe and c the
// largest channel of its colour, light passes the fibres with T(mu) = 1 - c E(mu):
//   f = colour * lobe + T(o) (interface + T(i) / N * base)
// The base, which scatters light to all sides, is dimmed for both directions: light that arrives at a grazing angle is
// not reflected twice. N makes a white cloth white: it is the mean of T over the light that reaches the base.
// ZELTNER: 0 is the lobe of the extension, 1 that of Zeltner et al. 2022.
#if ZELTNER
#include "bsdf/zeltner.glsl"
#else
#include "bsdf/charlie.glsl"
#endif
#include "bsdf/layer/interface.glsl"
#include "light/dfg.glsl"

struct Sheen {
    vec3 color;
    float perceptual_roughness;
    float largest;     // channel of the colour
    float throughput;  // T(o)
    float mean;        // N
    vec3 albedo;       // color E(o)
#if ZELTNER
    float E;           // E(o)
    vec2 transform;    // (a, b) of the linearly transformed cosine
#endif
};

// E
float sheen_reflectance(float mu, float perceptual_roughness) {
#if ZELTNER
    return zeltner_albedo(mu, perceptual_roughness);
#else
    return charlie_albedo(mu, perceptual_roughness);
#endif
}

float sheen_throughput(Sheen s, float mu) {
    return 1.0 - s.largest * sheen_reflectance(mu, s.perceptual_roughness);
}

Sheen make_sheen(vec3 color, float perceptual_roughness, float NoV) {
    Sheen s;
    s.color = color;
    s.perceptual_roughness = perceptual_roughness;
    s.largest = max3(color);
    s.throughput = sheen_throughput(s, NoV);
    s.albedo = color * sheen_reflectance(NoV, perceptual_roughness) * float(SHOW_SPECULAR);
    s.mean = 1.0;
#if ZELTNER
    s.E = sheen_reflectance(NoV, perceptual_roughness);
    s.transform = zeltner_transform(NoV, perceptual_roughness);
#endif
    return s;
}

// N over the base below the interface `face`, whose table is read with `roughness`: Gauss quadrature of
//   N = int T T_face b mu dmu / int T_face b mu dmu
// where b is what the base returns of the light from there, at the cosines SHEEN_NODES, over what Lambert's returns.
const vec4 SHEEN_NODES = vec4(0.06943184, 0.33000948, 0.66999052, 0.93056816);

float sheen_mean(Sheen s, Interface face, float roughness, vec4 b, sampler2D dfg) {
    vec4 weight = b * vec4(0.0241522, 0.2152141, 0.4369311, 0.3237026);
    vec2 sums = vec2(0.0);
    for (int k = 0; k < 4; ++k) {
        float passed = weight[k] * interface_transmittance(face, dfg_albedo(dfg, SHEEN_NODES[k], roughness));
        sums += passed * vec2(sheen_throughput(s, SHEEN_NODES[k]), 1.0);
    }
    return sums.y > 1e-6 ? sums.x / sums.y : 1.0; // no light reaches the base of a perfect mirror
}

vec3 sheen_response(Sheen s, Angles a) {
#if ZELTNER
    float lobe = s.E * zeltner_over_cosine(s.transform, a.NoV, a.NoL, 2.0 * a.VoH * a.VoH - 1.0);
#else
    float lobe = charlie(a.NoV, a.NoL, a.s2, s.perceptual_roughness);
#endif
    return s.color * (lobe * float(SHOW_SPECULAR));
}

// Samples the lobe, or all directions where it cannot be sampled, and the density of that
vec3 sheen_sample(Sheen s, vec3 wo, vec2 u) {
#if ZELTNER
    return zeltner_sample(s.transform, wo, u);
#else
    return sample_uniform_hemisphere(u);
#endif
}

float sheen_pdf(Sheen s, Angles a) {
#if ZELTNER
    return a.NoL * zeltner_over_cosine(s.transform, a.NoV, a.NoL, 2.0 * a.VoH * a.VoH - 1.0);
#else
    return 0.5 * INV_PI;
#endif
}

vec3 sheen_over(Sheen s, vec3 sheen, vec3 below) {
    return sheen + s.throughput * below;
}

// The axis of the cosine lobe that stands for the sheen under an environment. Fibres send light back: the mean
// direction leans from n towards the viewer. By quadrature, its slope is that of the code, for Charlie but for views
// along the normal, and Charlie's lobe is about as wide as that of the cosine.
vec3 sheen_axis(Sheen s, vec3 n, vec3 v, float NoV) {
    vec3 tangent = v - NoV * n;
    float sine = length(tangent);
#if ZELTNER
    float slope = -0.65 * s.transform.y / s.transform.x;
#else
    float r = clamp(s.perceptual_roughness, CHARLIE_SMOOTHEST, 1.0);
    float slope = (0.27 * pow(r, -1.2) - 0.09) * (0.75 + 1.1 * NoV);
#endif
    return normalize(n + tangent * (slope * min(4.0 * sine, 1.0) / max(sine, 1e-4)));
}

#if ZELTNER
// How much of the light from one side of the axis rather than from both the lobe gathers: the length of its mean
// direction over that of the cosine, 1.7 a / (a + 0.7) by quadrature. Smooth fibres gather light from all around the
// horizon, which for lack of a filtered map is taken as the mean of the light from both sides.
float sheen_sidedness(Sheen s) {
    return min(1.7 * s.transform.x / (s.transform.x + 0.7), 1.0);
}
#endif
