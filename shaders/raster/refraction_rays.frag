// Begins a path at each pixel's point on the front of solid glass: the refracted ray, or with u_is_mirrored the
// reflected one, in tracer space (the scene's centre is the origin and its radius the unit,
// viewer/trace/scene/geometry.py). With it goes the ray cone of the pixel: its width, and its spread, the growth of the
// width per unit of length. Akenine-Moeller et al. 2021, "Improved Shader and Texture Level of Detail Using Ray Cones".
#include "raster/material.glsl"
#include "raster/normal.glsl"

uniform vec3 u_eye;            // in tracer space
uniform vec3 u_view_direction; // towards the eye
uniform bool u_is_mirrored;
#if BANDS // one of red, green and blue, where any solid is dispersive; a reflected ray is all three
#include "bsdf/dispersion.glsl"

uniform int u_band;
#endif

// o_color: where the ray begins, relative to the eye, and 1
layout(location = 1) out vec4 o_origin;     // w: 1 for a ray
layout(location = 2) out vec4 o_direction;  // w: the spread
layout(location = 3) out vec4 o_throughput; // w: the width
layout(location = 4) out vec4 o_light;      // radiance found so far: none; w: alpha of the surface's roughness

// Offset of the origin from the surface: as in raster/reflection_rays.frag
const float OFFSET = 2e-5;

void main() {
    MaterialInputs m = read_inputs();
    float covered = coverage(m.base_color.a);
    float perceptual_roughness = m.perceptual_roughness;
    if (!u_is_mirrored) perceptual_roughness *= clamp(2.0 * m.ior - 2.0, 0.0, 1.0); // raster/transmission.glsl
    vec3 face = geometric_normal(), n = shading_normal(face);
#if IS_ORTHOGRAPHIC
    vec3 v = u_view_direction;
#else
    vec3 v = -normalize(v_position);
#endif
    vec3 mirrored = reflect(-v, n);
    mirrored -= 2.0 * min(dot(mirrored, face), 0.0) * face; // a shading normal may reflect it below the surface
    vec3 throughput = vec3(1.0);
#if BANDS
    if (!u_is_mirrored) throughput = vec3(u_band == 0, u_band == 1, u_band == 2);
#endif
#if DISPERSIVE
    m.ior = ior_of_bands(m.ior, m.dispersion)[u_band];
#endif
    vec3 d = u_is_mirrored ? mirrored : refract(-v, n, 1.0 / max(m.ior, 1.0));
    vec3 off = (u_is_mirrored ? OFFSET : -OFFSET) * max(1.0, length(v_position)) * face;
    vec3 px = dFdx(v_position), py = dFdy(v_position), dx = dFdx(d), dy = dFdy(d);
    float squared = dot(px, px) + dot(py, py);
    float width = sqrt(0.5 * squared);
    o_color = vec4(v_position, 1.0);
    o_origin = vec4(u_eye + v_position + off, 1.0);
    o_direction = vec4(normalize(d), (dot(px, dx) + dot(py, dy)) / max(squared, 1e-30) * width);
    o_throughput = vec4(throughput, width);
    o_light = vec4(vec3(0.0), perceptual_roughness * perceptual_roughness);
    drop_uncovered(covered);
}
