// Marches rays through the media of the scene and stores, at the ends of SLICES slices, what has come together between
// the eye and there: rgb: the light that is scattered towards the eye, a: 1 - transmittance. The last target carries
// light and optical depth on to the next slices (viewer/raster/media.py). Surfaces look it up by their distance
// (in_media.glsl), so all that lies in a medium is seen through the right amount of it.
#include "media/one_minus_exp.glsl"
#include "raster/in_scattered.glsl"

uniform float u_ends[SLICES + 1]; // the distance at which these slices start, and those at which they end
uniform int u_steps; // of each slice
uniform sampler2D u_carried;
uniform bool u_is_first; // nothing is carried

noperspective in vec3 v_ray, v_ray_origin; // eye-relative
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

const float DEEPEST = 16.0; // beyond this optical depth, less than 1e-7 of the light arrives

// Adds the light of a step of optical depth `depth`, whose mean collision is `part` of it after its start. Its source
// is taken for constant along the step, and integrated with the transmittance in closed form (Hillaire 2015).
void add_step(inout Path path, Ray ray, float from, float to, float depth, float part, Scattering medium) {
    if (depth <= 0.0) return;
    if (path.depth < DEEPEST) {
        float at = mix(from, to, part);
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
    add_step(path, ray, span.x, span.y, depth, mean_collision(depth), medium);
}
#endif

#if VOLUMES > 0
#if DENSE
const float THICK = 0.5; // optical depth of a part, and more behind what hides most
const float MOST_PARTS = 16.0, SEARCH = 6.0;

float extinction_on(Ray ray, int k, float at) {
    return volume_extinction(k, ray.origin + at * ray.direction);
}

// A step in volumes that may be thick. It begins where the volume does, which is searched, and is taken in parts, along
// each of which the extinction is taken for linear. So what is seen of a face does not depend on where steps end. The
// mean collision of a part is where as much optical depth lies before it as before one of a homogeneous step. Parts are
// as long as they may be if the extinction rises from where they start to the most in a voxel, and the last one is the
// rest.
void march_volumes(inout Path path, Ray ray, float from, float to, Scattering medium) {
    for (int k = 0; k < VOLUMES; ++k) {
        vec2 span = vec2(max(ray.volumes[k].x, from), min(ray.volumes[k].y, to));
        float start = 0.0, most = 0.0, rise = 0.0;
        if (span.x < span.y && path.depth < DEEPEST) {
            float middle = 0.5 * (span.x + span.y), inside = extinction_on(ray, k, middle);
            start = extinction_on(ray, k, span.x);
            most = max(max(start, inside), extinction_on(ray, k, span.y));
            float least = 1e-3 * most;
            vec2 face = inside > least ? vec2(span.x, middle) : vec2(middle, span.y);
            float turns = start < least ? SEARCH : 0.0;
            for (float turn = 0.0; turn < turns; ++turn) {
                middle = 0.5 * (face.x + face.y);
                face = extinction_on(ray, k, middle) > least ? vec2(face.x, middle) : vec2(middle, face.y);
            }
            if (start < least) span.x = face.x;
            vec3 voxels = abs(mat3(u_volume_box[k]) * ray.direction) / (2.0 * u_volume_margin[k]);
            rise = most * max(voxels.x, max(voxels.y, voxels.z));
        }
        float parts = most > 0.0 ? MOST_PARTS : 0.0;
        for (float j = 0.0; j < parts && span.x < span.y && path.depth < DEEPEST; ++j) {
            float thick = THICK * (1.0 + path.depth); // start at + rise at^2 / 2 = thick
            float width = 2.0 * thick / (start + sqrt(start * start + 2.0 * rise * thick));
            vec2 part = vec2(span.x, j + 1.0 < parts ? min(span.x + width, span.y) : span.y);
            width = part.y - part.x;
            float end = extinction_on(ray, k, part.y), depth = 0.5 * (start + end) * width;
            // width (start at + (end - start) at^2 / 2) = depth before the mean collision
            float q = 2.0 * depth * mean_collision(depth) / max(width, 1e-30);
            float at = q / max(start + sqrt(max(start * start + (end - start) * q, 0.0)), 1e-30);
            add_step(path, ray, part.x, part.y, depth, min(at, 1.0), medium);
            start = end;
            span.x = part.y;
        }
    }
}
#else
void march_volumes(inout Path path, Ray ray, float from, float to, Scattering medium) {
    for (int k = 0; k < VOLUMES; ++k) {
        vec2 span = vec2(max(ray.volumes[k].x, from), min(ray.volumes[k].y, to));
        float depth = 0.0;
        if (span.x < span.y) {
            vec3 middle = ray.origin + 0.5 * (span.x + span.y) * ray.direction;
            depth = volume_extinction(k, middle) * (span.y - span.x);
        }
        if (depth > 0.0) add_step(path, ray, span.x, span.y, depth, mean_collision(depth), medium);
    }
}
#endif
#endif

void main() {
    Ray ray = ray_through(v_ray_origin, normalize(v_ray));
#if FOG
    Scattering fog = fog_scattering(ray.direction);
#endif
#if VOLUMES > 0
    Scattering volumes = volume_scattering(ray.direction);
#endif
    vec4 carried = u_is_first ? vec4(0.0) : texelFetch(u_carried, ivec2(gl_FragCoord.xy), 0);
    Path path = Path(carried.rgb, carried.a);
    for (int k = 0; k < SLICES; ++k) {
        int j = 0;
        do { // with the condition at the top, llvmpipe would take a turn more, for nothing
            vec2 step = mix(vec2(u_ends[k]), vec2(u_ends[k + 1]), (float(j) + vec2(0.0, 1.0)) / float(u_steps));
#if FOG
            march_fog(path, ray, step.x, step.y, fog);
#endif
#if VOLUMES > 0
            march_volumes(path, ray, step.x, step.y, volumes);
#endif
        } while (++j < u_steps);
        o_slices[k] = vec4(path.light, one_minus_exp(path.depth));
    }
    o_slices[SLICES] = vec4(path.light, path.depth);
}
