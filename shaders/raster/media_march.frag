// Marches rays through the media of the scene and stores, at the ends of SLICES slices, what has come together between
// the eye and there: rgb: the light that is scattered towards the eye, a: 1 - transmittance. The last target carries
// light and optical depth on to the next slices (viewer/raster/media.py). Surfaces look it up by their distance
// (in_media.glsl), so all that lies in a medium is seen through the right amount of it.
#include "media/one_minus_exp.glsl"
#include "raster/in_scattered.glsl"

uniform mat3 u_ray;    // (x, y, 1) in normalised device coordinates to a direction, eye-relative
uniform mat3 u_origin; // and to the point that the ray starts from
uniform float u_ends[SLICES + 1]; // the distance at which these slices start, and those at which they end
uniform int u_steps; // of each slice
uniform sampler2D u_carried;
uniform bool u_is_first; // nothing is carried

in vec2 v_ndc;
layout(location = 0) out vec4 o_slices[SLICES + 1];

// Where the mean collision of a step of optical depth x happens, in steps from its start:
// int t x e^(-x t) dt / (1 - e^-x) = 1/x - 1/(e^x - 1)
float mean_collision(float x) {
    return x < 0.3 ? 0.5 - x / 12.0 + x * x * x / 720.0 : 1.0 / x - 1.0 / (exp(min(x, 80.0)) - 1.0);
}

// What a ray has met so far
struct Path {
    vec3 light;
    float depth;
};

// Adds the light of a step of optical depth `depth` that starts at `from`. Its source is taken for constant along the
// step, and integrated with the transmittance in closed form (Hillaire 2015).
void add_step(inout Path path, Ray ray, float from, float to, float depth, Scattering medium) {
    if (depth <= 0.0) return;
    if (path.depth < 16.0) { // beyond, less than 1e-7 of it arrives
        float at = mix(from, to, mean_collision(depth));
        path.light += exp(-path.depth) * one_minus_exp(depth) * source(ray, at, from, to, medium);
    }
    path.depth = min(path.depth + depth, 1e30);
}

#if FOG
// A step in the fog; volumes take its place where they are.
void march_fog(inout Path path, Ray ray, float from, float to, Scattering medium) {
    vec2 span = clamp(ray.fog, from, to);
    float depth = fog_depth(ray.origin, ray.direction, span.x, span.y);
#if VOLUMES > 0
    for (int k = 0; k < VOLUMES; ++k) {
        vec2 taken = clamp(ray.volumes[k], span.x, span.y);
        depth -= fog_depth(ray.origin, ray.direction, taken.x, taken.y);
    }
#endif
    add_step(path, ray, span.x, span.y, depth, medium);
}
#endif

#if VOLUMES > 0
void march_volumes(inout Path path, Ray ray, float from, float to, Scattering medium) {
    for (int k = 0; k < VOLUMES; ++k) {
        vec2 span = vec2(max(ray.volumes[k].x, from), min(ray.volumes[k].y, to));
        if (span.x >= span.y) continue;
        vec3 middle = ray.origin + 0.5 * (span.x + span.y) * ray.direction;
        add_step(path, ray, span.x, span.y, volume_extinction(k, middle) * (span.y - span.x), medium);
    }
}
#endif

void main() {
    Ray ray = ray_through(u_origin * vec3(v_ndc, 1.0), normalize(u_ray * vec3(v_ndc, 1.0)));
#if FOG
    Scattering fog = fog_scattering(ray.direction);
#endif
#if VOLUMES > 0
    Scattering volumes = volume_scattering(ray.direction);
#endif
    vec4 carried = u_is_first ? vec4(0.0) : texelFetch(u_carried, ivec2(gl_FragCoord.xy), 0);
    Path path = Path(carried.rgb, carried.a);
    for (int k = 0; k < SLICES; ++k) {
        for (int j = 0; j < u_steps; ++j) {
            vec2 step = mix(vec2(u_ends[k]), vec2(u_ends[k + 1]), (float(j) + vec2(0.0, 1.0)) / float(u_steps));
#if FOG
            march_fog(path, ray, step.x, step.y, fog);
#endif
#if VOLUMES > 0
            march_volumes(path, ray, step.x, step.y, volumes);
#endif
        }
        o_slices[k] = vec4(path.light, one_minus_exp(path.depth));
    }
    o_slices[SLICES] = vec4(path.light, path.depth);
}
