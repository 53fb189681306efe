// The environment's radiance, and directions sampled by it with the table of viewer/trace/scene/environment.py.
// HAS_ENVIRONMENT, ENVIRONMENT_ROTATED
#if HAS_ENVIRONMENT
#include "light/bilinear.glsl"
#include "light/environment_rotation.glsl"
#include "trace/equirect.glsl"

uniform sampler2D u_environment;
uniform usampler2D u_environment_table; // for each cell: threshold, column and row of the alias, densities of both
uniform vec2 u_environment_cell;        // size of a cell in texture coordinates; the last may be cut off at 1
uniform float u_environment_intensity;
uniform float u_environment_share;      // of all light samples

vec3 environment_radiance(vec3 d) {
    vec2 uv = precise_equirect_uv(to_environment(d));
    return bilinear(u_environment, uv) * u_environment_intensity;
}

// Density by solid angle with which sample_light chooses the direction d
float environment_pdf(vec3 d) {
    vec2 uv = precise_equirect_uv(to_environment(d));
    ivec2 cells = textureSize(u_environment_table, 0);
    ivec2 cell = clamp(ivec2(uv / u_environment_cell), ivec2(0), cells - 1);
    return u_environment_share * uintBitsToFloat(texelFetch(u_environment_table, cell, 0).z);
}

// The reverse of to_environment
vec3 from_environment(vec3 d) {
#if ENVIRONMENT_ROTATED
    float c = u_environment_rotation.x, s = u_environment_rotation.y;
    return vec3(c * d.x + s * d.z, d.y, c * d.z - s * d.x);
#else
    return d;
#endif
}

// Samples a direction. u.xy choose a cell uniformly, and u.z decides between the cell and its alias. The fractions of
// u.xy within the cell then place the direction uniformly by solid angle. If one number chose among all cells, fewer
// bits of it would be left for the place within the cell. The aliases of neighbours are neighbours
// (viewer/trace/scene/environment.py), so that points which are stratified in the square stay so on the sphere. Those
// of the first two dimensions of a Sobol sequence are so in all dyadic rectangles.
vec3 sample_environment(vec3 u, out float pdf) {
    ivec2 cells = textureSize(u_environment_table, 0);
    vec2 position = u.xy * vec2(cells);
    ivec2 cell = min(ivec2(position), cells - 1);
    vec2 inside = position - vec2(cell);
    uvec4 entry = texelFetch(u_environment_table, cell, 0);
    bool is_own = u.z < uintBitsToFloat(entry.x);
    if (!is_own) cell = ivec2(entry.y & 0xffffu, entry.y >> 16);
    pdf = u_environment_share * uintBitsToFloat(is_own ? entry.z : entry.w);

    vec2 low = vec2(cell) * u_environment_cell;
    vec2 high = min(low + u_environment_cell, 1.0);
    float phi = 2.0 * PI * (mix(low.x, high.x, inside.x) - 0.5);
    // (1 - cos theta) / 2 = sin^2(theta / 2), from the nearer pole, where 1 - cos theta itself would lose digits
    bool is_south = low.y + high.y > 1.0;
    vec2 edges = sin(0.5 * PI * (is_south ? 1.0 - vec2(low.y, high.y) : vec2(low.y, high.y)));
    float w = mix(edges.x * edges.x, edges.y * edges.y, inside.y);
    float sin_theta = 2.0 * sqrt(w * (1.0 - w));
    float cos_theta = is_south ? 2.0 * w - 1.0 : 1.0 - 2.0 * w;
    return from_environment(vec3(sin_theta * cos(phi), cos_theta, sin_theta * sin(phi)));
}
#else
vec3 environment_radiance(vec3 d) {
    return vec3(0.0);
}

float environment_pdf(vec3 d) {
    return 0.0;
}
#endif
