// Takes a mesh to eye-relative space: world axes, the eye at the origin, the scene's radius as the unit
// (viewer/scene/frame.py).
#include "raster/placement.glsl"
#include "raster/sees_lamps_through.glsl"
uniform mat4 u_view_projection;

in vec3 a_position;
out vec3 v_position;
#if HAS_NORMAL
in vec3 a_normal;
out vec3 v_normal;
#endif
#if HAS_TANGENT
in vec4 a_tangent;
out vec4 v_tangent;
uniform float u_handedness; // -1 where the model matrix mirrors
#endif
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
#if INDIRECT
in vec4 a_indirect;
out vec4 v_indirect;
#endif
#if SUBSURFACE
in vec4 a_interior;
out vec4 v_interior;
#if SEES_LAMPS_THROUGH
in vec3 a_other_side;
out vec3 v_other_side;
#endif
#if INDIRECT
in vec4 a_behind;
out vec4 v_behind;
#endif
#endif
#if IS_POINTS
uniform float u_point_size;
#endif

void transform_vertex() {
    mat4 model = model_matrix();
    vec4 p = model * vec4(a_position, 1.0);
    v_position = p.xyz;
    gl_Position = u_view_projection * p;
#if HAS_NORMAL
    v_normal = normal_matrix() * a_normal;
#endif
#if HAS_TANGENT
    v_tangent = vec4(mat3(model) * a_tangent.xyz, a_tangent.w * u_handedness);
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
#if INDIRECT
    v_indirect = a_indirect;
#endif
#if SUBSURFACE
    v_interior = a_interior;
#if SEES_LAMPS_THROUGH
    v_other_side = normal_matrix() * a_other_side;
#endif
#if INDIRECT
    v_behind = a_behind;
#endif
#endif
#if IS_POINTS
    gl_PointSize = u_point_size;
#endif
}
