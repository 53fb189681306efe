// Next-event estimation: one of all lights, chosen by the tables of viewer/trace/scene/lights.py. The density of what a BSDF
// sample could also have found, environment_pdf and emitter_pdf, is that of sample_light.
// HAS_ENVIRONMENT, HAS_PUNCTUAL, HAS_EMITTERS
const float FAR = 4.0; // all geometry lies within |p| <= 1

#include "trace/environment.glsl"
#if HAS_PUNCTUAL
#include "trace/punctual.glsl"
#endif
#if HAS_EMITTERS
#include "trace/emitters.glsl"
#endif

struct LightSample {
    vec3 direction;
    float distance;
    vec3 radiance; // irradiance of a surface that faces it, if it is delta
    float pdf;     // by solid angle, or the probability, if it is delta; 0: nothing
    bool is_delta; // no BSDF sample finds it
};

#if HAS_PUNCTUAL || HAS_EMITTERS
// By light, punctual ones first: bits of the threshold, alias, bits of its probability and of its alias's, that of any
// of them being chosen included
uniform int u_lights;
uniform int u_punctual_count;
uniform ivec2 u_light_grid; // the table's columns and rows

LightSample sample_finite_light(vec3 p, vec3 u) {
    vec2 position = u.zy * vec2(u_light_grid); // as sample_environment does
    ivec2 cell = min(ivec2(position), u_light_grid - 1);
    position -= vec2(cell);
    int k = cell.y * u_light_grid.x + cell.x;
    uvec4 entry = word(u_lights + k);
    bool is_own = u.x < uintBitsToFloat(entry.x);
    if (!is_own) k = int(entry.y);
    float probability = uintBitsToFloat(is_own ? entry.z : entry.w);

    LightSample s;
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

// u in [0, 1)^3
LightSample sample_light(vec3 p, vec3 u) {
    LightSample s = LightSample(vec3(0.0, 1.0, 0.0), FAR, vec3(0.0), 0.0, false);
#if HAS_ENVIRONMENT && (HAS_PUNCTUAL || HAS_EMITTERS)
    if (u.x >= u_environment_share) {
        u.x = (u.x - u_environment_share) / (1.0 - u_environment_share);
        return sample_finite_light(p, u);
    }
    u.x /= u_environment_share;
#elif HAS_PUNCTUAL || HAS_EMITTERS
    return sample_finite_light(p, u);
#endif
#if HAS_ENVIRONMENT
    s.direction = sample_environment(u, s.pdf);
    s.radiance = environment_radiance(s.direction);
#endif
    return s;
}

// Of a BSDF sample that met an emitter's shining side; the angle is that between its normal and the ray.
float emitter_pdf(int emitter, float area, float distance, float cos_light) {
#if HAS_EMITTERS
    float facing = area * cos_light;
    if (emitter < 0 || facing <= 0.0) return 0.0;
    return uintBitsToFloat(word(u_lights + u_punctual_count + emitter).z) * distance * distance / facing;
#else
    return 0.0;
#endif
}
