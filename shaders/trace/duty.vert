// One triangle over the whole wave, at the depth of a duty.
#include "trace/duty.glsl"

uniform int u_duty;

void main() {
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(corner * 2.0 - 1.0, duty_depth(u_duty) * 2.0 - 1.0, 1.0);
}
