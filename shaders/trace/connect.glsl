// Connects a vertex of a path from a light to the camera: light tracing, Veach 1997, "Robust Monte Carlo Methods for
// Light Transport Simulation", 4.5 and 8.2. The radiance of a pixel is the mean over its area a in the plane at depth 1
// (a box filter). The eye sees a surface element dA at depth w, at the angle theta to the view axis, in the solid angle
// dA cos_s / (w / cos theta)^2, and a solid angle covers 1 / cos^3 theta of it in that plane. So flux that leaves dA
// with the radiance L for a flux of 1 adds L times
//   cos_s / (a w^2 cos theta)
// to the pixel; cos_s, at the surface, is not in `importance`. An orthographic camera sees dA cos_s: w = cos theta = 1.
#include "trace/camera.glsl"
#include "trace/offset_origin.glsl"

// p.pdf of a photon, after its first surface: what its last vertex was, if any before was not of a delta lobe; else 0
const float FROM_ROUGH = 1.0, FROM_DELTA = 2.0;

uniform ivec2 u_camera_size;        // of the picture, in pixels that are traced
uniform mat3 u_camera_project;      // maps a point, after the vector below is added, to (x w, y w, w) with x and y in
uniform vec3 u_camera_project_from; // normalised device coordinates; w is the depth in a unit of its own, or always 1
uniform float u_camera_pixel_area;  // of a pixel at w = 1, in tracer units squared
#if HAS_SCATTERING || HAS_NESTED
uniform float u_camera_eta2; // as trace/generate.frag: a camera inside glass shows radiance over the index squared
#endif

// Where the picture shows p: x and y in pixels, and w
vec3 camera_pixel(vec3 p) {
    vec3 q = u_camera_project * p + u_camera_project_from;
    return vec3((q.xy / q.z + 1.0) / u_camera_pixel, q.z);
}

// Whether that pixel of the view is traced, and which pixel of the picture it is: the inverse of view_pixel
bool is_traced(vec2 view, out ivec2 p) {
    ivec2 from_first = ivec2(floor(view)) - u_camera_skip.y;
    p = from_first / (u_camera_skip.x + 1);
    return all(equal(p * (u_camera_skip.x + 1), from_first)) && all(greaterThanEqual(from_first, ivec2(0)))
        && all(lessThan(p, u_camera_size));
}

struct CameraSample {
    vec3 start;       // of the camera ray to the point
    vec3 direction;   // from the point to there
    float importance; // 0 if the camera does not look there
};

CameraSample sample_camera(vec3 p) {
    CameraSample c = CameraSample(p, vec3(0.0, 1.0, 0.0), 0.0);
    vec3 pixel = camera_pixel(p);
    ivec2 traced;
    if (!(pixel.z > 0.0 && all(lessThan(abs(pixel.xy), vec2(65536.0))) && is_traced(pixel.xy, traced))) return c;
    vec3 d;
    camera_ray(pixel.xy, c.start, d);
    if (dot(p - c.start, d) <= 0.0) return c;
    c.direction = -d;
    float per_depth = length(u_camera_ray * vec3(pixel.xy * u_camera_pixel - 1.0, 1.0)); // 1 / cos theta
    c.importance = per_depth / (pixel.z * pixel.z * u_camera_pixel_area);
#if HAS_SCATTERING || HAS_NESTED
    c.importance /= u_camera_eta2;
#endif
    return c;
}

// The shadow ray to the camera, from `origin`. `radiance` is what leaves towards the camera for the path's flux, times
// the cosine there; `medium` is the medium, or the nesting of media, on that side.
uniform float u_photon_power;

void connect_camera(inout Path p, vec3 position, vec3 origin, CameraSample c, int medium, vec3 radiance) {
    if (c.importance == 0.0) return;
#if HAS_SCATTERING
    p.shadow_medium = medium; // the shadow ray finds what is on its way
#else
    radiance *= transmittance(number_of(medium), distance(position, c.start));
#endif
    p.contribution = radiance * (c.importance * u_photon_power);
    if (p.contribution == vec3(0.0)) return;
    p.shadow_origin = origin;
    p.shadow_vector = c.start - origin;
}
