// Media between surfaces. A path carries the number of the medium that it travels in; number 0 is what is outside of
// all solids. A medium has MEDIUM_TEXELS texels of the scene buffer's section `media` (viewer/trace/scene/encode.py):
//   sigma_t, the extinction coefficient per tracer unit; the number of the phase function (media/any_phase.glsl)
//   in scenes with scattering, the albedo of a single scattering; 1 if no boundary of the medium refracts
//   in scenes with nested solids of glass, the index of refraction and the dispersion
// HAS_VOLUME: the scene has a medium besides the vacuum. HAS_SCATTERING: one of them scatters light.
#if HAS_VOLUME
#include "trace/scene_buffer.glsl"

uniform int u_media;
#endif
#if HAS_SCATTERING || HAS_NESTED
#include "media/nesting.glsl"
#endif

// The number of the medium in which a path travels, of the medium or the nesting of media that it carries
int number_of(int medium) {
#if HAS_SCATTERING || HAS_NESTED
    return innermost(medium);
#else
    return medium;
#endif
}

// Transmittance along a distance d in a medium: exp(-sigma_t d)       Beer 1852
vec3 transmittance(int medium, float distance) {
#if HAS_VOLUME
    return exp(-scene_float4(u_media + medium * MEDIUM_TEXELS).rgb * distance);
#else
    return vec3(1.0);
#endif
}

#if HAS_SCATTERING
struct Medium {
    vec3 sigma_t, albedo;
    float phase; // media/any_phase.glsl
    bool is_open; // no boundary refracts
};

Medium medium_of(int number) {
    int texel = u_media + number * MEDIUM_TEXELS;
    vec4 first = scene_float4(texel), second = scene_float4(texel + 1);
    return Medium(first.rgb, second.rgb, first.a, second.a > 0.0);
}

uniform bool u_has_light_within; // a light without size is in a medium that is not open

// Whether shadow rays from inside can reach lights. Behind a boundary that refracts they would all be lost.
bool asks_lights(Medium m) {
    return m.is_open || u_has_light_within;
}

bool scatters(Medium m) {
    return m.sigma_t * m.albedo != vec3(0.0);
}

// The way that media fill is cut off at a ball about the scene, so that a ray that leaves has a finite way in them.
// Returns the part of a ray that lies in the ball; start and end are the same if it misses it. d: unit length
vec2 media_span(vec3 o, vec3 d) {
    float b = dot(o, d);
    vec3 nearest = o - b * d;
    float half_chord = sqrt(max(MEDIA_REACH * MEDIA_REACH - dot(nearest, nearest), 0.0));
    return max(vec2(-half_chord, half_chord) - b, 0.0);
}

float leaves_media(vec3 o, vec3 d) {
    return media_span(o, d).y;
}

#if HAS_FOG
#include "media/fog_way.glsl"
#endif

// The length of the way of a ray in a medium between two distances. In fog, whose density varies, it is that of the
// same optical depth at the extinction of its record; all free distances and transmittances are of such lengths.
float length_in(int medium, vec3 o, vec3 d, float from, float to) {
#if HAS_FOG
    if (medium == 0) return fog_length(o, d, from, to);
#endif
    return max(to - from, 0.0);
}

// The distance along the ray at which such a length lies behind, 3e38 if the medium ends before
float distance_in(int medium, vec3 o, vec3 d, float way) {
#if HAS_FOG
    if (medium == 0) return fog_distance(o, d, way);
#endif
    return way;
}

// The density at a point of the medium, relative to its record
float density_in(int medium, vec3 p) {
#if HAS_FOG
    if (medium == 0) return fog_density(p);
#endif
    return 1.0;
}
#endif
