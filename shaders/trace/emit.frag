// Begins a photon at a light without size, or makes the texel idle if no photon is left. BEGINS: the first one of a new
// work item. It is aimed at a target: a box about surfaces that have delta lobes (viewer/trace/scene/photons.py).
// A light k and a target are chosen in proportion to the light's luminance Y(I) times the solid angle W of the target's
// cone, or times the area of its disk if the light is directional. With u_photon_power, the sum of these products, the
// density of a direction is Y(I) n / u_photon_power by solid angle, where n cones of this light hold the direction:
//   flux = I / pdf = u_photon_power * (I / Y(I)) / n,   of which the path carries all but the first factor
#include "bsdf/constants.glsl"
#include "light/attenuation.glsl"
#include "sample/luminance.glsl"
#include "sample/orthonormal_basis.glsl"
#include "trace/numbers.glsl"
#include "trace/scene_buffer.glsl"
#include "trace/write_state.glsl"

const int PAIR_TEXELS = 3;
const float BEFORE_SCENE = MEDIA_REACH + 2.0; // from the centre of a target: outside of the scene and of its media

uniform int u_punctual, u_photon_pairs;
uniform int u_photon_pair_count, u_photon_target_count;
uniform float u_light_radius;

// The first numbers of photons of all work items come from one sequence, which fills the targets evenly.
vec4 photon_numbers(ivec2 texel, Sample s, uint group) {
    ivec2 lane = texel % TILE;
    uint index = s.index * uint(TILE * TILE) + uint(lane.y * TILE + lane.x);
    return sobol_owen(index, hash(uint(s.pixel.x / TILE), u_seed, group));
}

// In the frame of the axis: the direction at the fraction u.x of a cone with 1 - cos = q, whose tangent is returned,
// too
vec3 in_cone(float q, vec2 u, out vec2 tangent) {
    float height = q * u.x, sin_theta = sqrt(height * (2.0 - height)), phi = 2.0 * PI * u.y;
    vec2 around = vec2(cos(phi), sin(phi));
    tangent = around * (sin_theta / max(1.0 - height, 1e-6));
    return vec3(around * sin_theta, 1.0 - height);
}

// The number of targets of light k whose cone or disk a ray of that light passes through; at least the one it is aimed
// at
float aimed(int k, bool is_far, vec3 o, vec3 d) {
    int count = 0;
    for (int target = 0; target < u_photon_target_count; ++target) {
        vec4 cone = scene_float4(u_photon_pairs + PAIR_TEXELS * (k * u_photon_target_count + target) + 1);
        vec3 away = is_far ? cross(cone.xyz - o, d) : d - cone.xyz; // |d - axis|^2 = 2 (1 - cos)
        count += int(dot(away, away) <= (is_far ? cone.w * cone.w : 2.0 * cone.w));
    }
    return float(max(count, 1));
}

Path emit(vec4 u, vec2 u_disk) {
    int pair = min(int(u.x * float(u_photon_pair_count)), u_photon_pair_count - 1);
    uvec4 entry = scene_uint4(u_photon_pairs + PAIR_TEXELS * pair);
    if (u.w >= uintBitsToFloat(entry.y)) pair = int(entry.z);
    int texel = u_photon_pairs + PAIR_TEXELS * pair, k = pair / u_photon_target_count;
    vec4 cone = scene_float4(texel + 1);  // axis, 1 - cos of the half angle; directional: centre and radius of the disk
    vec4 plane = scene_float4(texel + 2); // where the axis crosses the target; its distance from the light
    vec4 light = scene_float4(u_punctual + 3 * k), intensity = scene_float4(u_punctual + 3 * k + 1);
    vec4 axis = scene_float4(u_punctual + 3 * k + 2);
    bool is_far = light.w < 0.0; // directional

    Path p;
    p.pdf = p.travelled = 0.0;
#if HAS_SEE_THROUGH
    p.kept = 0.0;
#endif
#if HAS_LIGHT_TREE
    p.facing = 0.0;
#endif
    p.throughput = intensity.rgb / luminance(intensity.rgb);
    if (is_far) {
        p.direction = -light.xyz;
        float r = cone.w * sqrt(u.y), phi = 2.0 * PI * u.z;
        mat3 frame = orthonormal_basis(p.direction);
        p.origin = cone.xyz + frame * vec3(r * cos(phi), r * sin(phi), -BEFORE_SCENE);
    } else {
        vec2 tangent;
        mat3 frame = orthonormal_basis(cone.xyz);
        p.direction = normalize(frame * in_cone(cone.w, u.yz, tangent));
        p.origin = light.xyz;
        if (plane.w > BEFORE_SCENE) { // so that float32 does not lose digits to a large distance
            p.origin = plane.xyz + plane.w * (frame * vec3(tangent, 0.0)) - BEFORE_SCENE * p.direction;
            p.travelled = plane.w * sqrt(1.0 + dot(tangent, tangent)) - BEFORE_SCENE;
        }
#if LIGHT_RADIUS
        // A sphere of radiance I / (pi r^2) sends the flux I by solid angle through the disk that faces a direction.
        float r = u_light_radius * sqrt(u_disk.x), phi = 2.0 * PI * u_disk.y;
        p.origin += orthonormal_basis(p.direction) * vec3(r * cos(phi), r * sin(phi), 0.0);
#endif
        p.pdf = light.w; // 1 / range^2, until the photon meets the first surface
        p.throughput *= angular_attenuation(p.direction, axis.xyz, vec2(intensity.w, axis.w));
    }
    p.throughput /= aimed(k, is_far, p.origin, p.direction);
    p.radiance = p.shadow_origin = p.shadow_vector = p.contribution = vec3(0.0);
    p.depth = p.steps = 0;
    p.medium = int(scene_uint4(texel).x); // at the light
    p.eta2 = 1.0;
#if HAS_SCATTERING
    p.is_lit = false;
    p.shadow_medium = p.medium;
#endif
#if DISPERSIVE
    p.wavelength = 0.0;
#endif
    return p;
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
#if BEGINS
    int left = texelFetch(u_blocks, texel / TILE, 0).w;
#else
    int left = unpack_left(texelFetch(u_radiance, texel, 0).w);
#endif
    if (left == 0) {
        write_idle();
        return;
    }
    Sample s = path_sample(texel, left - 1);
    Path p = emit(photon_numbers(texel, s, EMISSION_GROUP), photon_numbers(texel, s, EMISSION_DISK_GROUP).xy);
    p.left = left - 1;
    write_path(p, p.throughput == vec3(0.0) ? ENDED : IN_FLIGHT);
}
