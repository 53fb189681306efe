// Prepares the input of the wavelet filter: the light divided by the albedo of the first hit, so that textures stay
// sharp, the variance of its luminance, and the guide.
#include "sample/luminance.glsl"
#include "trace/denoise/color.glsl"
#include "trace/denoise/guide.glsl"
#include "trace/is_finite.glsl"

uniform sampler2D u_radiance;  // mean, associated alpha
uniform sampler2D u_sum;       // rgb, number of samples
uniform sampler2D u_squares;
uniform sampler2D u_albedo;    // sum over the samples that hit something, w: their number
uniform sampler2D u_normal;    // likewise, w: sum of the depth
uniform sampler2D u_emission;  // sum of the emission of the first hits, w: how many of them were collisions in media
layout(location = 0) out vec4 o_light;
layout(location = 1) out vec4 o_guide;

// Mean depth at p, or `otherwise` where nothing is hit there.
float depth_at(ivec2 p, float otherwise) {
    p = clamp(p, ivec2(0), textureSize(u_normal, 0) - 1);
    float hits = texelFetch(u_albedo, p, 0).w;
    return hits > 0.0 ? texelFetch(u_normal, p, 0).w / hits : otherwise;
}

// The smaller of the slopes on both sides, because the larger one may cross an edge.
float slope(float before, float here, float after) {
    return abs(after - here) < abs(here - before) ? after - here : here - before;
}

void main() {
    ivec2 p = ivec2(gl_FragCoord.xy);
    vec3 radiance = texelFetch(u_radiance, p, 0).rgb;
    vec4 albedo = texelFetch(u_albedo, p, 0), normal = texelFetch(u_normal, p, 0);
    o_light = vec4(radiance, 0.0);
    o_guide = vec4(-1.0, 0.0, 0.0, 0.0);
    // The filter leaves such pixels out: the square of so large a value would not fit into float32.
    if (albedo.w == 0.0 || !is_finite(radiance) || max(radiance.r, max(radiance.g, radiance.b)) > 1e15) return;

    vec4 sum = texelFetch(u_sum, p, 0);
    float n = sum.w;
    vec4 emission = texelFetch(u_emission, p, 0);
    vec3 seen = emission.rgb / n;
    vec3 mean = sum.rgb / n;
    vec3 variance = max(texelFetch(u_squares, p, 0).rgb / n - mean * mean, 0.0) / max(n - 1.0, 1.0);
    vec3 color = demodulation(albedo);
    // The channels vary together, so their standard deviations add.
    float deviation = min(luminance(sqrt(variance) / color), 1e15);
    // Beside a lamp's emission the rest of the light is lost in rounding. variance.frag takes the neighbours' variance.
    if (seen != vec3(0.0)) deviation = 0.0;
    o_light = vec4(max(radiance - seen, 0.0) / color, deviation * deviation);

    // How many samples collide in a medium, and where, is noise: neither tells pixels apart.
    bool is_medium = emission.w > 0.0;
    float depth = is_medium ? NO_DEPTH : normal.w / albedo.w;
    vec2 gradient = vec2(slope(depth_at(p - ivec2(1, 0), depth), depth, depth_at(p + ivec2(1, 0), depth)),
                         slope(depth_at(p - ivec2(0, 1), depth), depth, depth_at(p + ivec2(0, 1), depth)));
    float size = length(normal.xyz);
    vec3 direction = size > 0.0 ? normal.xyz / size : vec3(0.0, 0.0, 1.0);
    float reflectance = min(luminance(albedo.rgb) / albedo.w, 1.0);
    float coverage = is_medium ? 1.0 : min(albedo.w / n, 1.0);
    o_guide = vec4(pack_guide(Guide(direction, coverage, reflectance)), depth, gradient);
}
