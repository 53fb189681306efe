// Shades yarns. Where fibres are drawn, each as a curve in the yarn's shadow. Where tubes are drawn, the mean of the
// fibres that the line of sight meets in the tube. Both have the light that comes through the yarn's own fibres by the
// depth at which they lie in it, and that of other yarns by shadow maps, so that they agree.
#include "raster/curve_shade.glsl"
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif
#include "raster/curve_light.glsl"
#include "raster/yarn_medium.glsl"

in vec3 v_yarn;          // from the yarn's axis to that of the strip, in radii of the yarn
in vec3 v_yarn_along;    // along the yarn
in float v_yarn_radius;  // in eye-relative units
uniform vec4 u_fibre;    // beta_m, beta_n, tilt, index of refraction
uniform vec2 u_turns;    // of plies about the yarn and fibres about their ply, in radians on a radius of its length

const int DEPTHS = 2;    // places on a line of sight, of equal opacity

struct Inside {
    vec3 p; // from the yarn's axis, in its radii, at a right angle to it
    vec3 t; // along the yarn
};

float own_depth(Inside at, vec3 d, out float way) {
    vec3 across = d - at.t * dot(d, at.t);
    float size = max(length(across), 1e-3);
    vec3 x = across / size;
    float b = dot(at.p, x);
    float out_of_it = max(sqrt(max(b * b + 1.0 - dot(at.p, at.p), 0.0)) - b, 0.0);
    way = min(out_of_it / size, 4.0);
    return u_yarn_depths.x * out_of_it;
}

// What light between fibres was worked out with is one fibre, in the mean of all colours. A yarn's own fibres scatter
// to each other in theirs: by so much more, as the colours of many fibres together say (sigma_a_of_color in
// viewer/scene/fibre.py) to a power, since a yarn has not so many. The power is fitted to mode path, by warp and weft
// of assets/curves/woven.hair.
const float OWN_POWER = 0.4;
#if HAS_COLORS && HAIR_LIGHT
uniform vec4 u_mean_fibre; // its absorption, and the factor of the root of an absorption

vec3 own_share() {
    return exp(-OWN_POWER * u_mean_fibre.w * (sqrt(absorption()) - sqrt(u_mean_fibre.rgb)));
}
#endif

#if HAS_ENVIRONMENT || HAIR_LIGHT
// From d, whose sine to the fibre is given, with the environment at the level `lod`. The yarn's own fibres may hide
// more than the grid knows of. Light that goes on almost straight through fibres is not hidden: the light between them,
// which comes from where they hide others, was worked out without it.
vec3 arriving_in_yarn(LightAround a, Inside at, vec3 d, float sine, float lod) {
    float way, depth = own_depth(at, d, way);
    vec3 arriving = vec3(0.0);
#if HAIR_LIGHT
    vec3 opacity = 1.0 - exp(-u_hair_kept * max(depth, depth_to_outside(a, d, sine)));
    arriving = a.scattered * opacity;
#if HAS_COLORS
    arriving += a.scattered * (own_share() - 1.0) * (1.0 - exp(-u_hair_kept * depth));
#endif
    arriving *= max(1.0 + dot(a.across.xyz, d), 0.0);
#else
    vec3 opacity = vec3(1.0 - exp(-depth));
#endif
#if HAS_ENVIRONMENT
    arriving += environment_level(d, lod) * (1.0 - opacity);
#endif
    return arriving;
}

// Light from all around, from the cone onto which the fibre scatters: the environment past the yarn's own fibres and
// others, and what these scatter where they hide it
vec3 around_in_yarn(SeenFibre s, mat3 frame, Inside at, vec3 position) {
    LightAround a = light_between_fibres(position);
    float step = 2.0 * PI / float(STEPS_ABOUT), lod = 0.0;
    vec3 radiance = vec3(0.0);
    int k = 0;
    do {
        float phi = (float(k) + 0.5) * step;
        mat3x4 lobes = far_lobes(s, phi) * step; // of the directions on both sides
        vec3 along = -s.wo.x * frame[0] + cos(phi) * s.wo.z * frame[2], aside = sin(phi) * s.wo.z * frame[1];
#if HAS_ENVIRONMENT
        lod = environment_lod(s, lobes, step);
#endif
        radiance += vec4(1.0) * lobes * (arriving_in_yarn(a, at, along + aside, -s.wo.x, lod)
                                         + arriving_in_yarn(a, at, along - aside, -s.wo.x, lod));
    } while (++k < STEPS_ABOUT / 2);
    return radiance;
}
#endif

// `h` and `pixels` as in curve.frag
vec3 radiance_of_fibre(CurvePoint point, Inside at, vec3 along, float h, float pixels) {
    point.along = along;
    CurveFrame c = curve_frame(point);
    Fibre f = Fibre(absorption(), u_fibre.x, u_fibre.y, u_fibre.z, u_fibre.w);
    SeenFibre s = seen_fibre(f, vec3(c.sine, 0.0, c.cosine), h, pixels);
    vec3 radiance = vec3(0.0);
#if HAS_ENVIRONMENT || HAIR_LIGHT
    radiance += around_in_yarn(s, c.axes, at, point.position);
#if MEDIA
    MediaLight media = light_around(point.position, vec3(0.0));
    radiance = radiance * media.sky + media.scattered;
#endif
#endif
#if LIGHT_COUNT > 0
    int i = 0;
    do {
        vec3 l, irradiance = light_before_shadow(i, point, l);
        float way, depth = own_depth(at, l, way);
        float past = 1.0;
#if SHADOW_LAYERS > 0
        if (has_shadow(i)) {
            bool is_point = i >= DIRECTIONAL_COUNT && i < DIRECTIONAL_COUNT + POINT_COUNT;
            vec3 outside = point.position + (way + 0.5) * v_yarn_radius * l;
            past = shadow_visibility(int(u_lights[i].direction.w), is_point, outside, l, l, u_lights[i].position.xyz);
        }
#endif
        float seen = exp(-depth) * past;
        vec3 wi = l * c.axes, response = seen > 0.0 ? seen * fibre_response(s, wi) : vec3(0.0);
#if HAIR_LIGHT
        // Through the yarn's own fibres, and through others where those hide the light
        ThroughFibres t = light_through_fibres(i, point.position);
        vec3 through = exp(-u_hair_kept * depth) * mix(t.share, vec3(1.0), past) - seen;
        response += through * response_through_fibres(s, wi, t.crossed);
#endif
        radiance += response * irradiance;
    } while (++i < LIGHT_COUNT);
#endif
    return radiance;
}

void main() {
    CurvePoint point;
    curve_point(point);
    Inside at;
    at.t = normalize(v_yarn_along);
    vec3 radiance = vec3(0.0);
    if (u_tube > 0.0) {
        CurveFrame c = curve_frame(point);
        float front = sqrt(max(1.0 - point.across * point.across, 0.0)), opacity = tube_opacity(point.across);
        int k = 0;
        do {
            float depth = -log(1.0 - opacity * (float(k) + 0.5) / float(DEPTHS)) / u_yarn_depths.y;
            vec3 q = u_tube * point.across * c.axes[1] + (u_tube * front - depth) * c.axes[2];
            at.p = v_yarn + q;
            vec3 along = at.t + u_turns.x * cross(at.t, at.p) + (u_tube < 1.0 ? u_turns.y : 0.0) * cross(at.t, q);
            radiance += radiance_of_fibre(point, at, normalize(along), 0.0, 0.0) / float(DEPTHS);
        } while (++k < DEPTHS);
    } else {
        at.p = v_yarn;
        radiance = radiance_of_fibre(point, at, point.along, point.across, point.pixels);
    }
    write_curve(radiance, point);
}
