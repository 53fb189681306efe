// Lights without size or, with LIGHT_RADIUS, spheres of one radius. viewer/trace/scene/punctual.py writes their
// records, three texels each.
#include "light/attenuation.glsl"
#include "trace/scene_buffer.glsl"
#if LIGHT_RADIUS
#include "bsdf/constants.glsl"
#include "sample/orthonormal_basis.glsl"

uniform float u_light_radius; // tracer units
#endif

uniform int u_punctual;

// Returns the irradiance at p of a surface that faces light i, 0 if the light does not reach p; gives the direction and
// the distance to the light.
vec3 punctual_irradiance(int i, vec3 p, vec2 u, out vec3 l, out float distance) {
    vec4 position = scene_float4(u_punctual + 3 * i);      // xyz, 1 / range^2; directional: the direction to it, -1
    vec4 intensity = scene_float4(u_punctual + 3 * i + 1); // candela or lux, scale of the cone
    if (position.w < 0.0) {
        l = position.xyz;
        distance = FAR * (1.0 + 0.01 * u.x); // no two rays are the same to shadow_ray_passes()
        return intensity.rgb;
    }
    vec4 axis = scene_float4(u_punctual + 3 * i + 2);      // direction of its light, offset of the cone
    vec3 d = position.xyz - p;
    float d2 = dot(d, d);
    distance = sqrt(d2);
    l = d * inversesqrt(max(d2, 1e-30));
    vec3 irradiance = intensity.rgb * distance_attenuation(d2, position.w, 1e-8)
                    * angular_attenuation(-l, axis.xyz, vec2(intensity.w, axis.w));
#if LIGHT_RADIUS
    // A sphere of radiance I / (pi r^2), sampled uniformly by solid angle. A surface that faces the sample has the
    // irradiance I / (pi r^2) omega, omega = 2 pi (1 - cos theta_max), sin theta_max = r / d (PBRT, 6.2.4).
    float sin2_max = u_light_radius * u_light_radius / max(d2, 1e-30);
    if (sin2_max >= 1.0) return vec3(0.0); // p is inside the sphere
    float half_max = 1.0 / (1.0 + sqrt(1.0 - sin2_max)); // (1 - cos theta_max) / sin^2 theta_max
    float q = u.x * sin2_max * half_max;                 // 1 - cos theta
    float sin2 = q * (2.0 - q);
    vec3 t = orthonormal_basis(l)[0];
    float phi = 2.0 * PI * u.y;
    distance = distance * (1.0 - q) - sqrt(max(u_light_radius * u_light_radius - d2 * sin2, 0.0));
    l = normalize((1.0 - q) * l + sqrt(sin2) * (cos(phi) * t + sin(phi) * cross(l, t)));
    irradiance *= 2.0 * half_max;
#endif
    return irradiance;
}
