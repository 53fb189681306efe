// Fog in a ball, which may thin out with height (viewer/scene/fog.py). FOG_HEIGHT: it does.
#if FOG_HEIGHT
#include "media/height_fog.glsl"
#endif

uniform vec4 u_fog_ball;        // centre and radius, in eye-relative units
uniform float u_fog_extinction; // sigma_t at the base and below, per eye-relative unit
#if FOG_HEIGHT
uniform vec2 u_fog_height; // y of the base, and 1 / scale height
#endif

// The part (from, to) of a ray that lies in the ball; from = to where it misses. d: unit length
vec2 fog_span(vec3 p, vec3 d) {
    vec3 c = p - u_fog_ball.xyz;
    float b = dot(c, d);
    vec3 nearest = c - b * d; // b^2 - |c|^2 + r^2 would lose digits of a ball that is far away
    float half_chord = sqrt(max(u_fog_ball.w * u_fog_ball.w - dot(nearest, nearest), 0.0));
    return vec2(-half_chord, half_chord) - b;
}

// The optical depth of the fog between two points of a ray inside the ball
float fog_depth(vec3 p, vec3 d, float from, float to) {
    float depth = u_fog_extinction * max(to - from, 0.0);
#if FOG_HEIGHT
    vec2 y = (p.y + d.y * vec2(from, to) - u_fog_height.x) * u_fog_height.y;
    depth *= mean_density(y.x, y.y);
#endif
    return depth;
}

// From p along d, as far as `reach`
float fog_depth_ahead(vec3 p, vec3 d, float reach) {
    vec2 span = clamp(fog_span(p, d), 0.0, reach);
    return fog_depth(p, d, span.x, span.y);
}

// Extinction at p
float fog_at(vec3 p) {
    vec3 c = p - u_fog_ball.xyz;
    if (dot(c, c) >= u_fog_ball.w * u_fog_ball.w) return 0.0;
#if FOG_HEIGHT
    return u_fog_extinction * exp(-max((p.y - u_fog_height.x) * u_fog_height.y, 0.0));
#else
    return u_fog_extinction;
#endif
}
