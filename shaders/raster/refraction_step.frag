// Takes each path of refraction_rays.frag from the surface it hit to the next ray. We follow only the stronger of the
// reflected and the transmitted ray, the trunk of Whitted's tree of rays (Whitted 1980, "An Improved Illumination Model
// for Shaded Display"). For the weaker one: light leaving the glass comes from the environment; light reflected inside
// is taken to be as bright as the ray we follow. A path that finds no way out brings no light.
//
// An opaque surface has the colour that the picture shows at the hit point. Where the picture shows nothing (the point
// is outside, or in the hole of a mask) the ray goes on.
#include "bsdf/fresnel.glsl"
#include "trace/hit.glsl"
#include "trace/shading_normal.glsl"
#include "raster/backdrop.glsl"
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif
#if BANDS // there is dispersion, so that red, green and blue take paths of their own
#include "bsdf/dispersion.glsl"

uniform int u_band;
#endif

uniform sampler2D u_origin, u_direction, u_throughput, u_light; // as refraction_rays.frag writes them
uniform usampler2D u_hit;     // viewer/trace/rays/intersect.py
uniform sampler2D u_surfaces; // viewer/raster/traced/refracting_surfaces.py
uniform int u_triangles;      // index of the first triangle's texel in u_surfaces
uniform vec3 u_eye;           // in tracer space

layout(location = 0) out vec4 o_origin;
layout(location = 1) out vec4 o_direction;
layout(location = 2) out vec4 o_throughput;
layout(location = 3) out vec4 o_light;

const float OFFSET = 1e-5;           // of the next ray's origin from the triangle
const float LEAST_THROUGHPUT = 0.01; // of a path that goes on
const float CONE = 0.25;             // alpha of the lobe that is as wide as a ray cone, over the cone's spread

struct Surface { // at a hit
    vec3 face, n;    // face and shading normal, outwards
    float distance;  // along the ray
    float curvature; // 1 / r on a sphere
    vec3 absorption, tint;
    float ior;       // 0: opaque
};

vec4 texel(int i) {
    int width = textureSize(u_surfaces, 0).x;
    return texelFetch(u_surfaces, ivec2(i % width, i / width), 0);
}

Surface surface_at(Hit hit, vec3 o, vec3 d) {
    vec4 absorption = texel(3 * hit.instance), glass = texel(3 * hit.instance + 1);
#if BANDS
    if (glass.w > 0.0) glass.w = ior_of_bands(glass.w, texel(3 * hit.instance + 2).x)[u_band];
#endif
    int first = u_triangles + 4 * (int(absorption.w) + hit.triangle);
    vec4 a = texel(first), b = texel(first + 1), c = texel(first + 2), plane = texel(first + 3);
    vec2 weights = hit.barycentric;
    vec3 n = a.xyz + weights.x * (b.xyz - a.xyz) + weights.y * (c.xyz - a.xyz);
    Surface s = Surface(vec3(a.w, b.w, c.w), n, 0.0, plane.y, absorption.rgb, glass.rgb, glass.w);
    float towards = dot(s.face, d);
    s.n = dot(s.n, s.n) > 1e-12 ? normalize(s.n) : s.face;
    s.distance = max((plane.x - dot(s.face, o)) / (abs(towards) < 1e-9 ? 1e-9 : towards), 0.0);
    return s;
}

vec3 environment_at(vec3 d, float alpha, float spread) {
#if HAS_ENVIRONMENT
    return environment_specular(normalize(d), sqrt(min(alpha + CONE * abs(spread), 1.0)));
#else
    return vec3(0.0);
#endif
}

// The path may hit the side of an opaque surface that faces away from the eye, of which the picture shows the other
// side. Returns the ratio of the irradiance on the hit side to that on a surface facing the eye, at most 1.
vec3 backface_ratio(Surface s, vec3 d, vec3 to_eye) {
#if HAS_ENVIRONMENT
    if (dot(faceforward(s.face, d, s.face), to_eye) < 0.0) {
        vec3 irradiance = environment_irradiance_over_pi(faceforward(s.n, d, s.face));
        return min(irradiance / max(environment_irradiance_over_pi(normalize(to_eye)), 1e-6), 1.0);
    }
#endif
    return vec3(1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    o_origin = texelFetch(u_origin, pixel, 0);
    o_direction = texelFetch(u_direction, pixel, 0);
    o_throughput = texelFetch(u_throughput, pixel, 0);
    o_light = texelFetch(u_light, pixel, 0);
    if (o_origin.w == 0.0) return;
    vec3 d = o_direction.xyz, throughput = o_throughput.rgb;
    float spread = o_direction.w, alpha = o_light.w;
    uvec4 answer = texelFetch(u_hit, pixel, 0);
    if (hit_kind(answer) == NO_KIND) {
        o_light.rgb += throughput * environment_at(d, alpha, spread);
        o_origin.w = 0.0;
        return;
    }
    Surface s = surface_at(unpack_hit(answer), o_origin.xyz, d);
    vec3 position = o_origin.xyz + s.distance * d;
    float width = o_throughput.w + spread * s.distance;
    vec3 next = d;
    if (s.ior == 0.0) {
        vec4 seen = backdrop_at(position - u_eye, sqrt(alpha));
        o_light.rgb += throughput * seen.rgb * backface_ratio(s, d, u_eye - position);
        throughput *= 1.0 - seen.a;
    } else {
        bool enters = dot(s.face, d) < 0.0;
        if (!enters) throughput *= exp(-s.absorption * s.distance);
        float side = enters ? 1.0 : -1.0;
        vec3 n = bend_normal(side * s.n, side * s.face, -d);
        float eta = enters ? s.ior : 1.0 / s.ior;
        float mu = clamp(dot(-d, n), 1e-4, 1.0);
        float R = f_dielectric(mu, eta);
        vec3 reflected = reflect(d, n), transmitted = refract(d, n, 1.0 / eta);
        float dn = side * s.curvature * width / mu; // turn of the normal across the cone
        if (R < 0.5) {
            if (enters) {
                o_light.rgb += throughput * R * environment_at(reflected, alpha, spread + 2.0 * dn);
                throughput *= 1.0 - R;
            }
            throughput *= s.tint;
            // ratio = d theta' / d theta, from Snell's law
            float mu_transmitted = max(dot(-transmitted, n), 1e-3), ratio = mu / (eta * mu_transmitted);
            spread = ratio * spread + (ratio - 1.0) * dn;
            width *= mu_transmitted / mu;
            next = transmitted;
        } else {
            if (!enters && R < 1.0) {
                o_light.rgb += throughput * (1.0 - R) * s.tint * environment_at(transmitted, alpha, spread);
                throughput *= R;
            }
            spread += 2.0 * dn;
            next = reflected;
        }
    }
    bool goes_on = max(throughput.r, max(throughput.g, throughput.b)) > LEAST_THROUGHPUT;
    o_origin = vec4(position + sign(dot(next, s.face)) * OFFSET * s.face, float(goes_on));
    o_direction = vec4(normalize(next), spread);
    o_throughput = vec4(throughput, width);
}
