// Radiance of a woven cloth in pbr.frag, which includes this file. The cloth is filtered: where a pixel covers more
// than a tenth of a yarn, the mean over several places in it. Where it covers the whole draft, these are places of the
// draft, the same for all pixels, so that nothing flickers; light is neither lost nor gained, since every place keeps
// it. Under supersampling the points that are shaded in a pixel share these places. Of cloth that is seen through
// narrow gaps of nearer cloth, a quarter of them is enough.
#if ALPHA_MODE == 2
#define WEAVE_HAS_GAPS 1
#else
#define WEAVE_HAS_GAPS 0
#endif
#include "bsdf/weave/weave.glsl"
#include "sample/lattice.glsl"

const int WEAVE_PLACES = 32;
const int WEAVE_SHARES = SHADED_SIDE > 1 ? 4 : 1; // of the places; a shaded point has one of them
const int WEAVE_LOOKUPS = 8; // of mirrored light, for one place; each of several has one
const int WEAVE_BEHIND = 4;  // one in so many places and lookups stands for the others where nearer cloth
const float WEAVE_NARROW = 1.0 / 32.0; // with gaps of no more than this share of it hides the point

uniform vec3 u_weave_places[WEAVE_PLACES]; // of the whole draft, in units of cells, each with its weight

// Of the places, the share that this point has
int weave_share() {
    ivec2 point = ivec2(gl_FragCoord.xy) % SHADED_SIDE;
    return (point.x + SHADED_SIDE * point.y) % WEAVE_SHARES;
}

// The place k of `count` about a shaded point, and its weight. `x` and `y` are the sides of what the point stands for
// in texture coordinates: of a pixel, or of a part of it. Places of the draft come in pairs of warp and weft.
vec3 weave_place(int k, int count, int share, vec2 uv, vec2 x, vec2 y) {
    vec2 extent = (abs(x) + abs(y)) * u_weave_density / vec2(u_weave_size) * float(SHADED_SIDE); // of the pixel
    float whole = smoothstep(1.0, 1.5, max(extent.x, extent.y)), among = float(share) / float(WEAVE_SHARES * count);
    if (hammersley(uint(k / 2), uint(count / 2)).y + 2.0 * among < whole) {
        int apart = WEAVE_PLACES / (WEAVE_SHARES * count), pair = apart * (WEAVE_SHARES * (k / 2) + share) + apart / 2;
        vec3 place = u_weave_places[2 * pair + k % 2];
        return vec3(place.xy / u_weave_density, place.z);
    }
    vec2 at = fract(hammersley(uint(k), uint(count)) + among) - 0.5;
    return vec3(uv + at.x * x + at.y * y, 1.0);
}

#if WEAVE_HAS_GAPS
#if !VISIBILITY
uniform sampler2D u_positions; // of the nearest cloth
uniform vec2 u_drawn_size;     // of the picture, in shaded points
#endif

// Whether nearer cloth hides the point but for narrow gaps: whether what the G-buffer has lies nearer by more than the
// surface here does anywhere in its texel. `v`: to the eye.
bool is_behind_cloth(vec3 v) {
    if ((1.0 - u_weave_yarns[2].w) * (1.0 - u_weave_yarns[7].w) > WEAVE_NARROW) return false;
    vec2 scale = vec2(textureSize(u_positions, 0)) / u_drawn_size;
    vec4 nearest = texelFetch(u_positions, ivec2(gl_FragCoord.xy * scale), 0);
    vec2 texel = vec2(length(dFdx(v_position)), length(dFdy(v_position))) / scale;
    return nearest.w != 0.0 && dot(nearest.xyz - v_position, v) > texel.x + texel.y;
}
#endif

vec3 shade_woven(Point p, float occlusion, vec4 visible, inout float covered) {
    vec2 x = dFdx(v_uv0), y = dFdy(v_uv0);
    vec3 px = dFdx(v_position), py = dFdy(v_position);
    float hand = x.x * y.y - y.x * x.y < 0.0 ? -1.0 : 1.0;
    vec3 t = tangent_beside(p.n, hand * (px * y.y - py * x.y));
    mat3 frame = mat3(t, cross(p.n, t), p.n);
    vec2 dv = ((hand * (py * x.x - px * y.x)) * frame).xy;
    dv *= inversesqrt(max(dot(dv, dv), 1e-30));
    vec3 wo = p.v * frame;
    wo.z = max(wo.z, 1e-4);
    bool is_front = gl_FrontFacing;

    vec3 above = vec3(0.0), below = vec3(0.0); // the light of the environment on both sides
#if HAS_ENVIRONMENT
    above = environment_irradiance_over_pi(p.n);
    below = environment_irradiance_over_pi(-p.n);
#endif
#if HAS_ENVIRONMENT
    // How much more of it a yarn gets whose normal leans, about: for one whose normal and p.n have the mean p.n + 0.3 t
    mat2x3 leaning = mat2x3(environment_irradiance_over_pi(normalize(p.n + 0.3 * frame[0])) - above,
                            environment_irradiance_over_pi(normalize(p.n + 0.3 * frame[1])) - above) / 0.6;
#endif
    mat2x3 shown = mat2x3(vec3(1.0), vec3(1.0)); // the share of mirrored light that other surfaces leave
#if HAS_ENVIRONMENT || INDIRECT || MEDIA
#if MEDIA
    light_through_media(p.n, p.n, shown, above);
#endif
    meet_other_surfaces(p.NoV, 0.5, occlusion, visible, shown, above);
#endif
#if LIGHT_COUNT > 0
    vec3 l[LIGHT_COUNT], irradiance[LIGHT_COUNT];
    for (int i = 0; i < LIGHT_COUNT; ++i) {
        irradiance[i] = punctual_irradiance(i, v_position, l[i]);
        float side = dot(p.n, l[i]) < 0.0 ? -1.0 : 1.0;
        irradiance[i] *= light_visibility(i, v_position, side * p.n_geometric, l[i]);
        l[i] = l[i] * frame;
    }
#endif

    WovenDeep deep[4]; // by `yarns` of weave_at
    for (int k = 0; k < 4; ++k) {
        int yarn_at = 5 * (k & 1);
        vec4 yarn = u_weave_yarns[yarn_at], other = k < 2 ? vec4(0.0, 0.0, 0.0, 1.0) : u_weave_yarns[5 - yarn_at];
        deep[k] = woven_deep(yarn.rgb, yarn.a, other.rgb, other.a, wo.z);
    }
    vec2 cells = (abs(x) + abs(y)) * u_weave_density;
    int apart = 1, share = weave_share();
#if WEAVE_HAS_GAPS
    if (is_behind_cloth(p.v)) apart = WEAVE_BEHIND;
#endif
    int places = max(cells.x, cells.y) > 0.1 ? WEAVE_PLACES / WEAVE_SHARES / apart : 1;
    int lookups = places > 1 ? 1 : WEAVE_LOOKUPS / apart;
    int samples = (max(places, 2 * lookups) + 3) / 4 * WEAVE_SHARES; // of each lobe, for warp or weft
    vec3 radiance = vec3(0.0);
    // Of what is mirrored, and of what has entered a fibre: light of the environment; weights of its samples; their sum
    // by the table
    mat2x3 once = mat2x3(0.0), weights = mat2x3(0.0), due = mat2x3(0.0);
    float straight = 0.0;
    for (int k = 0; k < places; ++k) {
        vec3 place = vec3(v_uv0, 1.0);
        if (places > 1) place = weave_place(k, places, share, v_uv0, x, y);
        int yarns;
        Woven m = weave_at(place.xy, vec2(1.0, 0.0), dv, is_front, yarns);
        WovenView v = woven_view(m, deep[yarns], wo, u_weave_table);
        straight += place.z * v.straight;
        vec3 sent = vec3(0.0);
        vec3 around = above;
#if HAS_ENVIRONMENT
        // What the yarn here sees, and those about it, are all the light from above.
        float own = (v.seen - v.mean_seen) / max(1.0 - v.mean_seen, 1e-3);
        around += clamp(own, -1.0, 1.0) * (leaning * m.normal.xy);
#endif
        sent += v.back * max(around, 0.0) + (v.through + v.onwards) * below;
#if HAS_ENVIRONMENT
        due += place.z * mat2x3(v.mirrored * m.specular, v.once - v.onwards);
        for (int j = 0; j < lookups && !woven_is_gap(m); ++j) {
            // In turn, for a pair of places if there are pairs; each of them and all points in a pixel have samples of
            // their own
            int turn = places > 2 ? k >> 1 : k + j, lobe = turn & 1;
            vec2 u = hammersley(uint((turn >> 1) * WEAVE_SHARES + share), uint(samples)).yx + 0.5 / float(samples);
            u = fract(u + 0.5 * float(k & 1));
            bool is_mirrored = lobe == 0;
            Flakes f = Flakes(m.axis, is_mirrored ? v.flakes.alpha : ENTERED_ALPHA);
            vec3 h = flakes_sample(f, wo, u);
            vec3 wi = 2.0 * dot(wo, h) * h - wo;
            vec3 weight = m.specular;
            if (is_mirrored) {
                weight *= flakes_fresnel(azimuth_about(m.axis, wo, wi));
            } else {
                wi = 2.0 * dot(m.axis, wi) * m.axis - wi;
                // What leaves on the other side is diffuse here; directions there stand for those mirrored to this one
                vec3 other = vec3(wi.xy, -wi.z);
                wi.z = abs(wi.z);
                float mirroring = flakes_mirroring(f, wo, 2.0 * dot(m.axis, other) * m.axis - other);
                float density = 0.25 * (flakes_density(f, h) + mirroring); // times the area of the flakes
                vec2 e = entered_once(m.axis, wo, wi, azimuth_about(m.axis, wo, wi)) / max(density, 1e-6);
                weight = m.passed * e.x + m.returned * e.y;
            }
            weight *= place.z * woven_weight(v, m.thickness, wo, wi);
            weights[lobe] += weight;
            once[lobe] += weight * environment_specular(frame * wi, is_mirrored ? 0.4 : 0.3);
        }
#endif
#if LIGHT_COUNT > 0
        for (int i = 0; i < LIGHT_COUNT; ++i) sent += woven_eval_pdf(m, v, wo, l[i], u_weave_table).rgb * irradiance[i];
#endif
        radiance += place.z * sent;
    }
    for (int j = 0; j < 2; ++j) radiance += shown[0] * once[j] * due[j] / max(weights[j], vec3(1e-6));
#if ALPHA_MODE == 2
    covered *= 1.0 - straight / float(places);
    return radiance / max(float(places) - straight, 1e-4); // what is written is multiplied by the coverage
#else
    return radiance / float(places);
#endif
}
