// Vertices for layers.frag: those of surface.vert, and where they are at the next time.
#include "raster/surface_vertex.glsl"
#if INSTANCED && OUT_IDS
in float a_instance; // from 1; a float32 has each up to 2^24
flat out vec2 v_instance; // its lower 16 bits and the rest
#endif
#if HAS_MOTION
in vec3 a_next;
uniform mat4 u_next_model;           // mesh to the eye-relative space of the next time
uniform mat4 u_next_view_projection;
out vec4 v_clip, v_next_clip;
#endif

void main() {
    transform_vertex();
#if INSTANCED && OUT_IDS
    v_instance = vec2(mod(a_instance, 65536.0), floor(a_instance / 65536.0));
#endif
#if HAS_MOTION
    v_clip = gl_Position;
    v_next_clip = u_next_view_projection * (u_next_model * vec4(a_next, 1.0));
#endif
}
