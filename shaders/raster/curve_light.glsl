// What a fibre does to light, seen from near and from afar. Near, the lobes of bsdf/fibre/fibre.glsl at the offset h
// where the ray meets the fibre. Afar, their mean over all h (viewer/bake/fibre.py), for a fibre that is thinner than a
// pixel. In between the two are mixed.
#include "bsdf/fibre/fibre.glsl"

uniform sampler3D u_fibre_table; // x: the angle about the fibre, y: cos theta_o, z: absorption; R, TT, TRT, the rest
const float HALF_ABSORPTION = 0.5;

// Widths in pixels between which the near lobes replace the far ones. NEAR is off where no fibre is so wide.
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
#if NEAR
    if (s.nearness > 0.0) response = s.nearness * (s.lobes.attenuation * fibre_densities(s.lobes, s.wo, wi));
#endif
    if (s.nearness < 1.0) response += (1.0 - s.nearness) * (along * far_lobes(s, atan(abs(wi.y), wi.z)));
    return response;
}

const int STEPS_ABOUT = 8; // directions about the fibre

#if HAIR_LIGHT
// Light between fibres, on a grid (viewer/bake/hair_light.py): the mean radiance that they scatter, from where they
// hide the outside, and the share of space that others than the one here fill; the Legendre moments 1 to 4 of its
// inclination to the fibres, over its mean; v, where more of it comes from across them, 1 + v . d times; and how open
// it is in the direction d along fibres t, 1 / (1 + the optical depth to the outside) = a + b . d + c (t . d)^2, with
// a in the first channel and c in the last one of u_hair_across. Of what fibres take away, the share u_hair_kept does
// not go on almost straight through them.
uniform sampler3D u_hair_scattered, u_hair_inclined, u_hair_across, u_hair_open;
uniform vec3 u_hair_kept;
uniform vec3 u_hair_low, u_hair_scale; // the grid's corner in eye-relative units, and 1 / its sides

vec3 in_hair(vec3 position) {
    return (position - u_hair_low) * u_hair_scale;
}

#if LIGHT_COUNT > 0
#include "raster/light_through_fibres.glsl"
#endif
#endif

#if HAS_ENVIRONMENT
// The level of the environment that stands for a lobe of the variance s^2. A level holds the environment under the
// highlight of GGX, whose tails are long: light that is far from a narrow lobe must not reach it. So the level is that
// of which half the light comes from as near as it does for a normal distribution: from within s sqrt(2 ln 2) of the
// middle, and of GGX from within 2 alpha, since the reflected direction turns by twice the angle of the half vector.
float lod_of_variance(float variance) {
    const float HALF_LN_2 = 0.34657359;
    return lod_of_roughness(min(sqrt(sqrt(HALF_LN_2 * variance)), 1.0));
}

// For light of one of several directions about the fibre, `step` apart: as wide as M of the lobes that count there and
// as `step`
float environment_lod(SeenFibre s, mat3x4 lobes, float step) {
    vec4 share = lobes[0] + lobes[1] + lobes[2];
    float along = dot(share, s.lobes.variance) / max(dot(share, vec4(1.0)), 1e-20);
    return lod_of_variance(0.5 * (along + step * step / 12.0 * s.wo.z * s.wo.z));
}
#endif

#if HAS_ENVIRONMENT || HAIR_LIGHT
// Light from all around over all lobes: from directions on the cone where theta_i = -theta_o, about which they lie.
struct LightAround {
    vec3 scattered; // mean radiance of light from fibres
    float filled;   // share of space that others fill
    vec4 across;    // where it comes from, and c
    vec4 open;      // a and b
};

LightAround light_between_fibres(vec3 position) {
#if HAIR_LIGHT
    vec3 at = in_hair(position);
    vec4 scattered = textureLod(u_hair_scattered, at, 0.0);
    return LightAround(scattered.rgb, scattered.a, textureLod(u_hair_across, at, 0.0),
                       textureLod(u_hair_open, at, 0.0));
#else
    return LightAround(vec3(0.0), 0.0, vec4(0.0), vec4(0.0));
#endif
}

// The optical depth to the outside in the direction d, whose sine to the fibre is given
float depth_to_outside(LightAround a, vec3 d, float sine) {
    return 1.0 / clamp(a.open.x + dot(a.open.yzw, d) + a.across.w * sine * sine, 1e-3, 1.0) - 1.0;
}

#if HAIR_LIGHT
#include "raster/depth_in_common.glsl"

// The depth to the outside, less what is known to be open: the fibre is seen along wo. Strips of depths below twice
// what they have in common end before they part. d and wo are in the frame of the fibre.
float depth_where_seen(LightAround a, mat3 frame, vec3 d, vec3 wo) {
    float depth = depth_to_outside(a, frame * d, d.x), both = min(depth, depth_to_outside(a, frame * wo, wo.x));
    float overlap = depth_in_common(a.filled, d.y, d.z);
    return depth - (both < 2.0 * overlap ? both - both * both / (4.0 * overlap) : overlap);
}
#endif

// `share` of the environment from d, at the level `lod`, and `inclined` of the light from fibres, which scatter it from
// where they hide the outside: in a white furnace the two add up to 1.
vec3 arriving_from(LightAround a, mat3 frame, vec3 d, vec3 wo, float lod, vec3 share, vec3 inclined) {
    vec3 radiance = vec3(0.0), opacity = vec3(0.0), towards = frame * d;
#if HAIR_LIGHT
    opacity = 1.0 - exp(-u_hair_kept * depth_where_seen(a, frame, d, wo));
    radiance = inclined * max(1.0 + dot(a.across.xyz, towards), 0.0) * a.scattered * opacity;
#endif
#if HAS_ENVIRONMENT
    radiance += share * environment_level(towards, lod) * (1.0 - opacity);
#endif
    return radiance;
}

// How much of the light from fibres each lobe gathers, over its mean. The lobe widens what it gathers from: a Legendre
// moment of order l counts exp(-l (l + 1) v / 2) times.
vec4 gathered_by_lobes(SeenFibre s, vec4 inclined) {
    vec4 gathered;
    for (int p = 0; p < 4; ++p) {
        float x = s.lobes.mean[p].y, x2 = x * x;
        vec4 legendre = vec4(x, 1.5 * x2 - 0.5, x * (2.5 * x2 - 1.5), (4.375 * x2 - 3.75) * x2 + 0.375);
        vec4 widened = exp(-vec4(1.0, 3.0, 6.0, 10.0) * s.lobes.variance[p]);
        gathered[p] = max(1.0 + dot(inclined, vec4(3.0, 5.0, 7.0, 9.0) * legendre * widened), 0.0);
    }
    return gathered;
}

#if NEAR
// Near, each lobe gathers light from about its middle; what is reflected inside more often, as TRT
vec3 light_about_offset(SeenFibre s, LightAround a, vec4 gathered, mat3 frame) {
    mat4x3 A = s.lobes.attenuation;
    A[2] += A[3];
    float lod = 0.0, about = PI * PI / 3.0 * s.lobes.scale * s.lobes.scale * s.wo.z * s.wo.z; // of the logistic N
    vec3 radiance = vec3(0.0);
    for (int p = 0; p < 3; ++p) {
        vec2 across = complex_product(vec2(0.0, 1.0), s.lobes.turn[p]);
        vec3 d = vec3(s.lobes.mean[p].y, s.lobes.mean[p].x * across);
#if HAS_ENVIRONMENT
        lod = lod_of_variance(min(s.lobes.variance[p], about)); // no light from beside a narrow lobe
#endif
        radiance += arriving_from(a, frame, d, s.wo, lod, A[p], gathered[p] * A[p]);
    }
    return radiance;
}
#endif

vec3 light_about_fibre(SeenFibre s, mat3 frame, vec3 position) {
    LightAround a = light_between_fibres(position);
    vec4 gathered = vec4(1.0);
#if HAIR_LIGHT
    gathered = gathered_by_lobes(s, textureLod(u_hair_inclined, in_hair(position), 0.0));
#endif
    float step = 2.0 * PI / float(STEPS_ABOUT);
    float lod = 0.0;
    vec3 radiance = vec3(0.0);
    int k = 0;
    do {
        float phi = float(k) * step;
        mat3x4 lobes = far_lobes(s, phi) * step;
        vec3 share = vec4(1.0) * lobes, inclined = gathered * lobes; // the integral of M is 1
        vec3 d = vec3(-s.wo.x, sin(phi) * s.wo.z, cos(phi) * s.wo.z);
#if HAS_ENVIRONMENT
        lod = environment_lod(s, lobes, step);
#endif
        radiance += arriving_from(a, frame, d, s.wo, lod, share, inclined);
        if (k == 0 || 2 * k == STEPS_ABOUT) continue;
        radiance += arriving_from(a, frame, vec3(d.x, -d.y, d.z), s.wo, lod, share, inclined);
    } while (++k <= STEPS_ABOUT / 2);
#if NEAR
    radiance = mix(radiance, light_about_offset(s, a, gathered, frame), s.nearness);
#endif
    return radiance;
}
#endif
