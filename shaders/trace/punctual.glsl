// Lights without size, or spheres of one radius (LIGHT_RADIUS), as viewer/trace/scene/punctual.py packs them, three words each.
#include "light/attenuation.glsl"
#include "trace/words.glsl"
#if LIGHT_RADIUS
#include "bsdf/constants.glsl"
#include "trace/shading_normal.glsl"

uniform float u_light_radius; // tracer units
#endif

uniform int u_punctual;

// Direction to light i from p, how far it is, and the irradiance of a surface that faces it; 0 if there is none.
vec3 punctual_irradiance(int i, vec3 p, vec2 u, out vec3 l, out float distance) {
    vec4 place = word_float(u_punctual + 3 * i);         // position, 1 / range^2; or where it shines from, -1
    vec4 intensity = word_float(u_punctual + 3 * i + 1); // candela or lux, scale of the cone
    if (place.w < 0.0) {
        l = place.xyz;
        distance = FAR;
        return intensity.rgb;
    }
    vec4 axis = word_float(u_punctual + 3 * i + 2);      // where it shines to, offset of the cone
    vec3 d = place.xyz - p;
    float d2 = dot(d, d);
    distance = sqrt(d2);
    l = d * inversesqrt(max(d2, 1e-30));
    vec3 irradiance = intensity.rgb * distance_attenuation(d2, place.w)
                    * angular_attenuation(-dot(l, axis.xyz), vec2(intensity.w, axis.w));
#if LIGHT_RADIUS
    // A sphere of radiance I / (pi r^2), whose directions are taken evenly: what faces any of them has the irradiance
    // I / (pi r^2) omega, omega = 2 pi (1 - cos theta_max), sin theta_max = r / d (Pharr et al., "PBRT", 6.2.4).
    float sin2_max = u_light_radius * u_light_radius / max(d2, 1e-30);
    if (sin2_max >= 1.0) return vec3(0.0); // inside it
    float half_max = 1.0 / (1.0 + sqrt(1.0 - sin2_max)); // (1 - cos theta_max) / sin^2 theta_max
    float q = u.x * sin2_max * half_max;                 // 1 - cos theta
    float sin2 = q * (2.0 - q);
    vec3 t = any_tangent(l);
    float phi = 2.0 * PI * u.y;
    distance = distance * (1.0 - q) - sqrt(max(u_light_radius * u_light_radius - d2 * sin2, 0.0));
    l = normalize((1.0 - q) * l + sqrt(sin2) * (cos(phi) * t + sin(phi) * cross(l, t)));
    irradiance *= 2.0 * half_max;
#endif
    return irradiance;
}
