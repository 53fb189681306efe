// One triangle over the whole wavefront, at the depth of one path class.
#include "trace/path_class.glsl"

uniform int u_path_class;

void main() {
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(corner * 2.0 - 1.0, class_depth(u_path_class) * 2.0 - 1.0, 1.0);
}
