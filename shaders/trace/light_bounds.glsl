// A group of lights, and about how much of its light arrives at a receiver: Conty Estevez & Kulla 2018, "Importance
// Sampling of Many Lights with Adaptive Tree Splitting", section 4.1. viewer/trace/scene/light_bounds.py writes the
// records, two texels each.
#include "sample/octahedron.glsl"
#include "trace/scene_buffer.glsl"
#if HAS_AIRLIGHT
#include "media/equiangular.glsl"
#endif

struct LightBounds {
    vec3 center;     // of a sphere about the lights
    float radius;
    float intensity; // relative
    vec3 axis;       // of the cone in which they shine
    float cos_spread;
    float reach;     // no light comes further
    uint flags;
    uint link;       // trace/light_tree.glsl
};

// What light is sampled for
struct Receiver {
    vec3 position;
    vec3 normal; // of a surface that light from behind does not reach; 0: light from all around counts
    float way;   // 0: a point. Else a ray of this length through a medium, in the direction `normal`, lit by lamps only
};

// The lights of a group are nearer to its centre than its edge is: light is weighed as if from a sphere of this part of
// the radius. Tried in rooms with 100 to 10,000 lights, it makes the variance a third of what it is with the sphere
// itself.
const float CORE = 0.4;
const float LEAST_COSINE = 0.1;     // where light may arrive, though hardly any from the core
const float NORMAL_SLACK = 0.003;   // more than a normal is off that trace/facing.glsl has packed
const float NEAREST2 = 1e-8;        // as in light/attenuation.glsl

LightBounds light_bounds(int texel) {
    vec4 sphere = scene_float4(texel);
    uvec4 rest = scene_uint4(texel + 1);
    LightBounds b;
    b.center = sphere.xyz;
    b.radius = sphere.w;
    b.intensity = uintBitsToFloat(rest.x);
    b.axis = from_octahedron(vec2(rest.y & 0xffffu, rest.y >> 16) * (1.0 / 32767.0) - 1.0);
    b.cos_spread = float(rest.z & uint(LIGHT_COSINE_STEPS)) * (2.0 / float(LIGHT_COSINE_STEPS)) - 1.0;
    b.flags = rest.z >> LIGHT_FLAG_SHIFT;
    uint reach = rest.z >> 16;
    b.reach = reach == 0xffffu ? 3e38 : exp2(float(reach) / float(LIGHT_REACH_STEPS) - float(LIGHT_REACH_LOW));
    b.link = rest.w;
    return b;
}

// The window of the range, by the least distance to the lights
float reach_window(float nearest, float reach) {
    float x = max(nearest, 0.0) / reach;
    x *= x;
    return max(1.0 - x * x, 0.0);
}

// 0 only if no light of the group arrives. With the angle a to the cone's axis, that s of the cone and that r of the
// sphere, seen from the point, light may arrive where a - s - r is below a right angle:
//   cos(max(a - s, 0)) > -sin r;   of a narrow cone where it is not above 0:   sin(max(a - s, 0)) <= sin r
// A light with a normal beyond the horizon is lower than the sphere's radius below it.
float importance_at_point(LightBounds b, vec3 p, vec3 n) {
    vec3 to_center = b.center - p;
    float distance2 = dot(to_center, to_center), per_distance = inversesqrt(max(distance2, 1e-30));
    vec3 l = to_center * per_distance;
    float sphere = b.radius * per_distance, core = CORE * sphere; // sines; the point is inside where they are above 1

    float c = -dot(b.axis, l);
    if ((b.flags & uint(LIGHT_TWO_SIDED)) != 0u) c = abs(c);
    float sine = sqrt(max(1.0 - c * c, 0.0)), sin_spread = sqrt(1.0 - b.cos_spread * b.cos_spread);
    bool is_within = c >= b.cos_spread;
    float cos_beyond = is_within ? 1.0 : c * b.cos_spread + sine * sin_spread;
    float sin_beyond = is_within ? 0.0 : sine * b.cos_spread - c * sin_spread;
    bool is_narrow = (b.flags & uint(LIGHT_NARROW)) != 0u;
    float leaving = is_narrow ? (min(c + core, 1.0) - b.cos_spread) / max(1.0 - b.cos_spread, 1e-4) : cos_beyond + core;
    bool is_lit = sphere >= 1.0 || (is_narrow ? cos_beyond > 0.0 && sin_beyond <= sphere : cos_beyond > -sphere);

    float arriving = 1.0;
    if (n != vec3(0.0)) {
        float facing = dot(n, l);
        is_lit = is_lit && facing + NORMAL_SLACK > -sphere;
        arriving = clamp(facing + core, LEAST_COSINE, 1.0);
    }
    float core_radius = CORE * b.radius;
    float weight = clamp(leaving, LEAST_COSINE, 1.0) * arriving
                 * reach_window(distance2 * per_distance - b.radius, b.reach);
    return is_lit ? b.intensity * weight / max(max(distance2, core_radius * core_radius), NEAREST2) : 0.0;
}

#if HAS_AIRLIGHT
// Of lamps for a ray: the integral of 1 / d^2 along it. It bends to no cone.
float importance_along_ray(LightBounds b, Receiver ray) {
    if ((b.flags & uint(LIGHT_LAMP)) == 0u) return 0.0;
    Equiangular e = equiangular(ray.position, ray.normal, ray.way, b.center);
    float closest = max(e.closest, CORE * b.radius);
    float angle = angle_of(closest * ray.way, closest * closest + e.start * (e.start + ray.way));
    float along = clamp(-e.start, 0.0, ray.way);
    float nearest = length(ray.position + along * ray.normal - b.center) - b.radius;
    return b.intensity * angle / closest * reach_window(nearest, b.reach);
}
#endif

float light_importance(LightBounds b, Receiver r) {
#if HAS_AIRLIGHT
    if (r.way > 0.0) return importance_along_ray(b, r);
#endif
    return importance_at_point(b, r.position, r.normal);
}
