// The paths that refraction_rays.frag begins, from the surface that each has met to the next. Of reflected and
// transmitted light what is more is followed: of a tree of rays (Whitted 1980, "An Improved Illumination Model for
// Shaded Display") the trunk. What leaves glass beside it is looked up in the environment; what is reflected inside,
// where less is, is taken to be as bright as what is followed. Nothing comes along paths that have found no way out.
// What is opaque has the colour of the picture where the point that was met stands in it; a ray goes on where it does
// not, as through the holes of a mask.
#include "bsdf/fresnel.glsl"
#include "trace/shading_normal.glsl"
#include "raster/backdrop.glsl"
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif

uniform sampler2D u_origin, u_direction, u_kept, u_light; // as refraction_rays.frag writes them
uniform usampler2D u_hit;                                 // viewer/trace/rays/intersect.py
uniform sampler2D u_surfaces;                             // viewer/raster/traced/refracting_surfaces.py
uniform int u_triangles;                                  // where they begin in it
uniform vec3 u_eye;                                       // in tracer space

layout(location = 0) out vec4 o_origin;
layout(location = 1) out vec4 o_direction;
layout(location = 2) out vec4 o_kept;
layout(location = 3) out vec4 o_light;

const uint INSTANCE_MASK = 0x0fffffffu;
const float OFFSET = 1e-5;  // off the triangle that was met
const float LEAST = 0.01;   // of light that is worth a ray
const float CONE = 0.25;    // alpha of the lobe that is as wide as a cone, over the cone's spread

struct Met {
    vec3 face, n;     // outwards, of the triangle and for shading
    float along;      // the ray, as far as here
    float curvature;  // 1 / r on a ball
    vec3 absorption, tint;
    float ior;        // 0: opaque
};

vec4 texel(int i) {
    int width = textureSize(u_surfaces, 0).x;
    return texelFetch(u_surfaces, ivec2(i % width, i / width), 0);
}

Met met_at(uvec4 hit, vec3 o, vec3 d) {
    int instance = int(hit.x & INSTANCE_MASK);
    vec4 absorption = texel(2 * instance), glass = texel(2 * instance + 1);
    int first = u_triangles + 4 * (int(absorption.w) + int(hit.y));
    vec4 a = texel(first), b = texel(first + 1), c = texel(first + 2), plane = texel(first + 3);
    vec2 weights = uintBitsToFloat(hit.zw);
    Met met = Met(vec3(a.w, b.w, c.w), a.xyz + weights.x * (b.xyz - a.xyz) + weights.y * (c.xyz - a.xyz), 0.0, plane.y,
                  absorption.rgb, glass.rgb, glass.w);
    float towards = dot(met.face, d);
    met.n = dot(met.n, met.n) > 1e-12 ? normalize(met.n) : met.face;
    met.along = max((plane.x - dot(met.face, o)) / (abs(towards) < 1e-9 ? 1e-9 : towards), 0.0);
    return met;
}

vec3 environment_at(vec3 d, float alpha, float spread) {
#if HAS_ENVIRONMENT
    return environment_specular(normalize(d), sqrt(min(alpha + CONE * abs(spread), 1.0)));
#else
    return vec3(0.0);
#endif
}

// Of a side that faces away the picture shows the other one: how much darker it is, were all of it diffuse.
vec3 as_lit(Met met, vec3 d, vec3 to_eye) {
#if HAS_ENVIRONMENT
    if (dot(faceforward(met.face, d, met.face), to_eye) < 0.0) {
        vec3 here = environment_irradiance_over_pi(faceforward(met.n, d, met.face));
        return min(here / max(environment_irradiance_over_pi(normalize(to_eye)), 1e-6), 1.0);
    }
#endif
    return vec3(1.0);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    o_origin = texelFetch(u_origin, pixel, 0);
    o_direction = texelFetch(u_direction, pixel, 0);
    o_kept = texelFetch(u_kept, pixel, 0);
    o_light = texelFetch(u_light, pixel, 0);
    if (o_origin.w == 0.0) return;
    vec3 d = o_direction.xyz, kept = o_kept.rgb;
    float spread = o_direction.w, alpha = o_light.w;
    uvec4 hit = texelFetch(u_hit, pixel, 0);
    if ((hit.x & INSTANCE_MASK) == INSTANCE_MASK) { // nothing but the environment
        o_light.rgb += kept * environment_at(d, alpha, spread);
        o_origin.w = 0.0;
        return;
    }
    Met met = met_at(hit, o_origin.xyz, d);
    vec3 position = o_origin.xyz + met.along * d;
    float width = o_kept.w + spread * met.along;
    vec3 next = d;
    if (met.ior == 0.0) {
        vec4 seen = backdrop_at(position - u_eye, sqrt(alpha));
        o_light.rgb += kept * seen.rgb * as_lit(met, d, u_eye - position);
        kept *= 1.0 - seen.a;
    } else {
        bool enters = dot(met.face, d) < 0.0;
        if (!enters) kept *= exp(-met.absorption * met.along);
        float side = enters ? 1.0 : -1.0;
        vec3 n = bend_normal(side * met.n, side * met.face, -d);
        float eta = enters ? met.ior : 1.0 / met.ior;
        float mu = clamp(dot(-d, n), 1e-4, 1.0);
        float R = f_dielectric(mu, eta);
        vec3 reflected = reflect(d, n), through = refract(d, n, 1.0 / eta);
        float turned = side * met.curvature * width / mu; // the normal, across the cone
        if (R < 0.5) {
            if (enters) {
                o_light.rgb += kept * R * environment_at(reflected, alpha, spread + 2.0 * turned);
                kept *= 1.0 - R;
            }
            kept *= met.tint;
            // d theta' / d theta, of Snell's law
            float mu_beyond = max(dot(-through, n), 1e-3), ratio = mu / (eta * mu_beyond);
            spread = ratio * spread + (ratio - 1.0) * turned;
            width *= mu_beyond / mu;
            next = through;
        } else {
            if (!enters && R < 1.0) {
                o_light.rgb += kept * (1.0 - R) * met.tint * environment_at(through, alpha, spread);
                kept *= R;
            }
            spread += 2.0 * turned;
            next = reflected;
        }
    }
    bool goes_on = max(kept.r, max(kept.g, kept.b)) > LEAST;
    o_origin = vec4(position + sign(dot(next, met.face)) * OFFSET * met.face, float(goes_on));
    o_direction = vec4(normalize(next), spread);
    o_kept = vec4(kept, width);
}
