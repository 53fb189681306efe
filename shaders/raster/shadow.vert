// Depth of what casts a shadow, seen from the light.
#if INSTANCED
#include "raster/placement.glsl" // to scene units
uniform mat4 u_to_light;
#else
uniform mat4 u_model_to_light;
#endif
#if PANE
uniform mat4 u_model_to_unit;
out vec3 v_position; // in scene units
#endif
in vec3 a_position;
#if UV_SETS & 1
in vec2 a_uv0;
out vec2 v_uv0;
#endif
#if UV_SETS & 2
in vec2 a_uv1;
out vec2 v_uv1;
#endif
#if HAS_COLOR
in vec4 a_color;
out vec4 v_color;
#endif

void main() {
#if INSTANCED
    gl_Position = u_to_light * (model_matrix() * vec4(a_position, 1.0));
#else
    gl_Position = u_model_to_light * vec4(a_position, 1.0);
#endif
#if PANE
    v_position = (u_model_to_unit * vec4(a_position, 1.0)).xyz;
#endif
#if UV_SETS & 1
    v_uv0 = a_uv0;
#endif
#if UV_SETS & 2
    v_uv1 = a_uv1;
#endif
#if HAS_COLOR
    v_color = a_color;
#endif
}
