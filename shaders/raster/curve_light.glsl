// What a fibre does to light, seen from near and from afar. Near, the lobes of bsdf/fibre/fibre.glsl at the offset h
// where the ray meets the fibre. Afar, their mean over all h (viewer/bake/fibre.py), for a fibre that is thinner than a
// pixel. In between the two are mixed.
#include "bsdf/fibre/fibre.glsl"

uniform sampler3D u_fibre_table; // x: the angle about the fibre, y: cos theta_o, z: absorption; R, TT, TRT, the rest
const float HALF_ABSORPTION = 0.5;

// Widths in pixels between which the near lobes replace the far ones
const vec2 NEAR_PIXELS = vec2(1.5, 3.0);

// A fibre seen along wo = (sin theta_o, 0, cos theta_o)
struct SeenFibre {
    Fibre fibre;
    vec3 wo;
    float nearness;   // 0 far, 1 near
    FibreLobes lobes; // near; their means and variances hold afar, too
};

SeenFibre seen_fibre(Fibre f, vec3 wo, float h, float pixels) {
    return SeenFibre(f, wo, smoothstep(NEAR_PIXELS.x, NEAR_PIXELS.y, pixels), fibre_lobes(f, h, wo));
}

// Light about the fibre, R, TT, TRT and the rest, a column for each channel
mat3x4 far_lobes(SeenFibre s, float phi) {
    vec3 size = vec3(textureSize(u_fibre_table, 0));
    float y = (s.wo.z * (size.y - 1.0) + 0.5) / size.y;
    vec3 z = s.fibre.sigma_a / (s.fibre.sigma_a + HALF_ABSORPTION);
    z = (z * (size.z - 1.0) + 0.5) / size.z;
    mat3x4 found;
    for (int c = 0; c < 3; ++c) found[c] = textureLod(u_fibre_table, vec3(phi * INV_PI, y, z[c]), 0.0);
    return found;
}

// BCSDF times |cos theta_i|
vec3 fibre_response(SeenFibre s, vec3 wi) {
    vec2 theta = vec2(length(wi.yz), wi.x);
    vec4 along;
    for (int p = 0; p < 4; ++p) along[p] = longitudinal(theta, s.lobes.mean[p], s.lobes.variance[p]);
    vec3 response = vec3(0.0);
    if (s.nearness > 0.0) response = s.nearness * (s.lobes.attenuation * fibre_densities(s.lobes, s.wo, wi));
    if (s.nearness < 1.0) response += (1.0 - s.nearness) * (along * far_lobes(s, atan(abs(wi.y), wi.z)));
    return response;
}

#if HAIR_LIGHT
// Light from other fibres, on a grid (viewer/bake/hair_light.py): the mean radiance that they scatter, and how much they
// hide in the direction d, a + b . d with a in the first channel.
uniform sampler3D u_hair_scattered, u_hair_hidden;
uniform vec3 u_hair_low, u_hair_scale; // the grid's corner in eye-relative units, and 1 / its sides

vec3 in_hair(vec3 position) {
    return (position - u_hair_low) * u_hair_scale;
}

#if LIGHT_COUNT > 0
uniform sampler3D u_hair_depths; // optical depth to each light, one grid above the other along z
uniform float u_hair_onward;     // of what fibres take away, the share that does not go on almost straight through them

// The share of light i that comes through fibres almost straight on, beside what comes past them
float light_through_fibres(int i, vec3 position) {
    float margin = 0.5 * float(LIGHT_COUNT) / float(textureSize(u_hair_depths, 0).z);
    vec3 at = in_hair(position);
    at.z = (clamp(at.z, margin, 1.0 - margin) + float(i)) / float(LIGHT_COUNT);
    float depth = textureLod(u_hair_depths, at, 0.0).r;
    return exp(-depth) - exp(-depth / u_hair_onward);
}
#endif
#endif

#if HAS_ENVIRONMENT || HAIR_LIGHT
// Light from all around over all lobes: from so many directions on the cone where theta_i = -theta_o, about which they
// lie. A lookup of the environment is as wide as R along the fibre and as the distance of the directions about it.
const int STEPS_ABOUT = 8;

vec3 arriving_from(vec3 d, float lod, vec4 hidden, vec3 scattered) {
    float opacity = clamp(hidden.x + dot(hidden.yzw, d), 0.0, 1.0);
    vec3 radiance = vec3(0.0);
#if HAS_ENVIRONMENT
    radiance += environment_level(d, lod) * (1.0 - opacity);
#endif
    // Fibres scatter light from where they hide the sky: in a white furnace the two add up to 1.
    return radiance + scattered * (opacity / max(hidden.x, 1e-4));
}

vec3 light_about_fibre(SeenFibre s, mat3 frame, vec3 position) {
    vec4 hidden = vec4(0.0);
    vec3 scattered = vec3(0.0);
#if HAIR_LIGHT
    hidden = textureLod(u_hair_hidden, in_hair(position), 0.0);
    scattered = textureLod(u_hair_scattered, in_hair(position), 0.0).rgb;
#endif
    float step = 2.0 * PI / float(STEPS_ABOUT), lod = 0.0;
#if HAS_ENVIRONMENT
    float variance = 0.5 * (s.lobes.variance.x + step * step / 12.0 * s.wo.z * s.wo.z);
    lod = lod_of_roughness(min(sqrt(sqrt(variance)), 1.0)); // a half vector turns by half the angle
#endif
    vec3 radiance = vec3(0.0);
    for (int k = 0; k <= STEPS_ABOUT / 2; ++k) {
        float phi = float(k) * step;
        vec3 share = vec4(step) * far_lobes(s, phi); // the integral of M is 1
        vec3 d = vec3(-s.wo.x, sin(phi) * s.wo.z, cos(phi) * s.wo.z);
        vec3 arriving = arriving_from(frame * d, lod, hidden, scattered);
        if (k > 0 && 2 * k < STEPS_ABOUT) arriving += arriving_from(frame * vec3(d.x, -d.y, d.z), lod, hidden, scattered);
        radiance += share * arriving;
    }
    return radiance;
}
#endif
