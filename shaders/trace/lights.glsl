// Next-event estimation: samples one of all lights with the tables of viewer/trace/scene/lights.py. environment_pdf and
// emitter_pdf give the density of sample_light for a direction that a BSDF sample has chosen.
// HAS_ENVIRONMENT, HAS_PUNCTUAL, HAS_EMITTERS; HAS_LIGHT_TREE: a tree chooses among lamps and emissive triangles, by
// where they are, and the table among directional lights alone.
#include "trace/environment.glsl"
#if HAS_PUNCTUAL
#include "trace/punctual.glsl"
#endif
#if HAS_EMITTERS
#include "trace/emitters.glsl"
#endif
#if HAS_LIGHT_TREE
#include "trace/light_tree.glsl"
#endif

struct LightSample {
    vec3 direction;
    float distance;
    vec3 radiance; // of a delta light: the irradiance of a surface that faces it
    float pdf;     // by solid angle; of a delta light: the probability of choosing it; 0: there is no sample
    bool is_delta; // a light without size, which no BSDF sample can hit
};

#if HAS_PUNCTUAL || HAS_EMITTERS
// The alias table, one texel for each light, punctual lights first: threshold (float bits), alias, probability of the
// light and of its alias (float bits). The probabilities include that of sampling a finite light at all.
uniform int u_lights;
uniform int u_punctual_count;
uniform ivec2 u_light_grid; // the table's columns and rows

// Chooses a light; `rest` is in [0, 1)^2 and independent of the choice.
int choose_light(vec3 u, out float probability, out vec2 rest) {
    rest = u.xy * vec2(u_light_grid); // as in sample_environment
    ivec2 cell = min(ivec2(rest), u_light_grid - 1);
    rest -= vec2(cell);
    int k = cell.y * u_light_grid.x + cell.x;
    uvec4 entry = scene_uint4(u_lights + k);
    bool is_own = u.z < uintBitsToFloat(entry.x);
    if (!is_own) k = int(entry.y);
    probability = uintBitsToFloat(is_own ? entry.z : entry.w);
    return k;
}

#if HAS_LIGHT_TREE
uniform float u_far_share;  // of light samples that are not of the environment: those of directional lights
uniform float u_tree_share; // of all light samples

// As choose_light for a receiver; k is -1, with a probability of 0, where there is nothing to choose
int choose_finite_light(Receiver r, vec3 u, out float probability, out vec2 rest) {
    if (u.x < u_far_share) {
        u.x /= u_far_share;
        return choose_light(u, probability, rest);
    }
    u.x = (u.x - u_far_share) / (1.0 - u_far_share);
    rest = u.xy;
    int k = choose_in_tree(r, rest, probability);
    probability *= u_tree_share;
    rest.y = u.z;
    return k;
}
#endif

#if HAS_AIRLIGHT && HAS_LIGHT_TREE
uniform float u_air_far_share; // of samples of lights without size: those of directional lights
uniform float u_finite_share;  // the sum of the table's probabilities

// Chooses a light without size for a ray, as choose_finite_light does
int choose_punctual(Receiver ray, vec3 u, out float probability, out vec2 rest) {
    if (u.x < u_air_far_share) {
        u.x /= u_air_far_share;
        int k = choose_light(u, probability, rest);
        probability *= u_air_far_share / u_finite_share;
        return k;
    }
    u.x = (u.x - u_air_far_share) / (1.0 - u_air_far_share);
    rest = u.xy;
    int k = choose_in_tree(ray, rest, probability);
    probability *= 1.0 - u_air_far_share;
    rest.y = u.z;
    return k;
}
#elif HAS_AIRLIGHT
uniform float u_finite_share;  // the sum of the table's probabilities
uniform float u_emitter_share; // of those, that of emitters

// Chooses a light without size: as choose_light does, and with equal chances where that chooses an emitter.
int choose_punctual(vec3 u, out float probability, out vec2 rest) {
    int k = choose_light(u, probability, rest);
    float even = 0.0;
#if HAS_EMITTERS
    even = u_emitter_share / float(u_punctual_count);
    if (k >= u_punctual_count) {
        rest.x *= float(u_punctual_count);
        k = min(int(rest.x), u_punctual_count - 1);
        rest.x -= float(k);
    }
#endif
    probability = uintBitsToFloat(scene_uint4(u_lights + k).z) / u_finite_share + even;
    return k;
}
#endif

LightSample sample_finite_light(vec3 p, vec3 n, vec3 u) {
    float probability;
    vec2 position;
    LightSample s;
#if HAS_LIGHT_TREE
    int k = choose_finite_light(Receiver(p, n, 0.0), u, probability, position);
    if (k < 0) return LightSample(vec3(0.0, 1.0, 0.0), FAR, vec3(0.0), 0.0, false);
#else
    int k = choose_light(u, probability, position);
#endif

#if HAS_PUNCTUAL && HAS_EMITTERS
    s.is_delta = k < u_punctual_count;
#else
    s.is_delta = bool(HAS_PUNCTUAL);
#endif
    s.pdf = probability;
#if HAS_PUNCTUAL
    if (s.is_delta) s.radiance = punctual_irradiance(k, p, position, s.direction, s.distance);
#endif
#if HAS_EMITTERS
    if (!s.is_delta) {
        float density;
        s.radiance = sample_emitter(k - u_punctual_count, p, position, s.direction, s.distance, density);
        s.pdf *= density;
    }
#endif
    if (s.radiance == vec3(0.0)) s.pdf = 0.0;
    return s;
}
#endif

// For a point p; `n` is the geometric normal of a surface that light from behind does not reach, or 0. Without
// HAS_LIGHT_TREE it changes nothing. u in [0, 1)^3
LightSample sample_light(vec3 p, vec3 n, vec3 u) {
    LightSample s = LightSample(vec3(0.0, 1.0, 0.0), FAR, vec3(0.0), 0.0, false);
#if HAS_ENVIRONMENT && (HAS_PUNCTUAL || HAS_EMITTERS)
    if (u.z >= u_environment_share) {
        u.z = (u.z - u_environment_share) / (1.0 - u_environment_share);
        return sample_finite_light(p, n, u);
    }
    u.z /= u_environment_share;
#elif HAS_PUNCTUAL || HAS_EMITTERS
    return sample_finite_light(p, n, u);
#endif
#if HAS_ENVIRONMENT
    s.direction = sample_environment(u, s.pdf);
    s.radiance = environment_radiance(s.direction);
#endif
    return s;
}

// The density with which sample_light would choose the direction of a BSDF sample that hit an emitter's emitting side.
// It began at p with the normal n, as in sample_light; cos_light is the cosine between the emitter's normal and the
// ray.
float emitter_pdf(int emitter, float area, vec3 p, vec3 n, float distance, float cos_light) {
#if HAS_EMITTERS
    float facing = area * cos_light;
    if (emitter < 0 || facing <= 0.0) return 0.0;
#if HAS_LIGHT_TREE
    uvec4 record = scene_uint4(u_emitters + emitter);
    float probability = record.w == 0u ? 0.0 : u_tree_share * probability_in_tree(Receiver(p, n, 0.0), record.z);
#else
    float probability = uintBitsToFloat(scene_uint4(u_lights + u_punctual_count + emitter).z);
#endif
    return probability * distance * distance / facing;
#else
    return 0.0;
#endif
}
