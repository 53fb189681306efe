// Begins the next sample of a path that has ended, or makes it idle if no sample is left. BEGINS: begins the first
// sample of a new work item instead, except, with HAS_SKY, in pixels that no triangle can touch, and, with
// CHOOSES_PIXELS, in pixels that the item is not for. LIT: the path begins on a surface, and emissive triangles light
// that by light_receiver (trace/generate_lit.frag).
#include "trace/numbers.glsl"
#include "trace/write_state.glsl"
#if RAYS
#include "trace/surface_ray.glsl"
#else
#include "trace/camera.glsl"
#endif

#if BEGINS
uniform ivec2 u_size; // of the picture
#endif
#if BEGINS && HAS_SKY
uniform sampler2D u_sky; // of viewer/trace/paths/sky.py
#endif
#if BEGINS && CHOOSES_PIXELS
uniform sampler2D u_chosen; // 1 at the homes of the pixels that the work items are for
#endif
#if (HAS_SCATTERING || HAS_NESTED) && !RAYS
uniform int u_camera_medium; // the nesting of media around the eye
uniform float u_camera_eta2; // the square of the index there
#endif

void main() {
#if BEGINS
    ivec2 texel = ivec2(gl_FragCoord.xy), home = home_of(texel);
    ivec4 block = texelFetch(u_blocks, home / TILE, 0);
    bool is_inside = all(lessThan(block.xy * TILE + home % TILE, u_size));
#if HAS_SKY
    is_inside = is_inside && texelFetch(u_sky, block.xy * TILE + home % TILE, 0).a == 0.0;
#endif
#if CHOOSES_PIXELS
    is_inside = is_inside && texelFetch(u_chosen, home, 0).r > 0.0;
#endif
    int left = is_inside ? block.w : 0;
#else
    ivec2 texel = source_of(ivec2(gl_FragCoord.xy));
    int left = unpack_left(texelFetch(u_radiance, texel, 0).w);
#endif
    if (left == 0) {
        write_idle();
        return;
    }
    Path p;
    p.left = left - 1;
    Sample s = path_sample(texel, p.left);
    vec2 u = sample_numbers(s, CAMERA_GROUP).xy;
#if RAYS
    RayPoint at;
    if (!ray_point(s.pixel, at)) {
        write_idle();
        return;
    }
    surface_ray(at, u, p.origin, p.direction);
#else
    camera_ray(vec2(view_pixel(s.pixel)) + u, p.origin, p.direction); // a box filter over the pixel
#endif
    p.pdf = p.travelled = 0.0;
#if HAS_SEE_THROUGH
    p.kept = 0.0;
#endif
#if HAS_LIGHT_TREE
    p.facing = 0.0;
#endif
    p.throughput = vec3(1.0);
    p.radiance = p.shadow_origin = p.shadow_vector = p.contribution = vec3(0.0);
    p.depth = int(RAYS == 1); // a path to a surface counts the scattering at that surface
    p.steps = 0;
    p.medium = 0;
    p.eta2 = 1.0;
#if (HAS_SCATTERING || HAS_NESTED) && !RAYS
    // A camera inside glass shows radiance divided by the square of the index, which is the same on both sides of the
    // surface, so that the picture does not become brighter when the camera moves inside.
    p.medium = u_camera_medium;
    p.eta2 = u_camera_eta2;
    p.throughput /= p.eta2;
#endif
#if HAS_SCATTERING
    p.is_lit = false;
    p.shadow_medium = p.medium;
#endif
#if DISPERSIVE
    p.wavelength = 0.0;
#endif
#if LIT
    light_receiver(p, at, s);
#endif
    write_path(p, IN_FLIGHT);
}
