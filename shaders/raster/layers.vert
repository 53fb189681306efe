// Vertices for layers.frag: those of surface.vert, and where they are at the next time.
#include "raster/surface_vertex.glsl"
#if HAS_MOTION
in vec3 a_next;
uniform mat4 u_next_model;           // mesh to the eye-relative space of the next time
uniform mat4 u_next_view_projection;
out vec4 v_clip, v_next_clip;
#endif

void main() {
    transform_vertex();
#if HAS_MOTION
    v_clip = gl_Position;
    v_next_clip = u_next_view_projection * (u_next_model * vec4(a_next, 1.0));
#endif
}
