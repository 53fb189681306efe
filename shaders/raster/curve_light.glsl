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

#if HAS_ENVIRONMENT
// The environment over all lobes: from so many directions on the cone where theta_i = -theta_o, about which they lie. A
// lookup is as wide as R along the fibre and as the distance of the directions about it.
const int ENVIRONMENT_STEPS = 8;

vec3 fibre_environment(SeenFibre s, mat3 frame) {
    float step = 2.0 * PI / float(ENVIRONMENT_STEPS);
    float variance = 0.5 * (s.lobes.variance.x + step * step / 12.0 * s.wo.z * s.wo.z);
    float lod = lod_of_roughness(min(sqrt(sqrt(variance)), 1.0)); // a half vector turns by half the angle
    vec3 radiance = vec3(0.0);
    for (int k = 0; k <= ENVIRONMENT_STEPS / 2; ++k) {
        float phi = float(k) * step;
        vec3 share = vec4(step) * far_lobes(s, phi); // the integral of M is 1
        vec3 d = vec3(-s.wo.x, sin(phi) * s.wo.z, cos(phi) * s.wo.z);
        vec3 arriving = environment_level(frame * d, lod);
        if (k > 0 && 2 * k < ENVIRONMENT_STEPS) arriving += environment_level(frame * vec3(d.x, -d.y, d.z), lod);
        radiance += share * arriving;
    }
    return radiance;
}
#endif
