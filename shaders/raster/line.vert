// Lines of a given width in pixels: each is an instance, a strip of four corners that faces the screen.
uniform mat4 u_model;           // to eye-relative space, as in surface.vert
uniform mat4 u_view_projection;
uniform vec2 u_nearer;          // how much nearer to the eye lines are drawn than they are, lest their surface hides
                                // them: as a share of the way, and in eye-relative units
uniform vec3 u_view_direction;  // towards the eye
uniform vec2 u_size;            // of the target in pixels
uniform float u_width;          // in pixels of the target

in vec3 a_from, a_to;
noperspective out float v_across; // pixels from the middle of the line
flat out float v_length;          // pixels

const float LEAST_W = 1e-6; // what is nearer to the eye's plane is cut off

void main() {
    vec4 a = u_model * vec4(a_from, 1.0), b = u_model * vec4(a_to, 1.0);
    a = u_view_projection * vec4(a.xyz * (1.0 - u_nearer.x) + u_nearer.y * u_view_direction, 1.0);
    b = u_view_projection * vec4(b.xyz * (1.0 - u_nearer.x) + u_nearer.y * u_view_direction, 1.0);
    if (a.w < LEAST_W && b.w > LEAST_W) a = mix(a, b, (LEAST_W - a.w) / (b.w - a.w));
    else if (b.w < LEAST_W && a.w > LEAST_W) b = mix(b, a, (LEAST_W - b.w) / (a.w - b.w));
    vec2 along = (b.xy / b.w - a.xy / a.w) * 0.5 * u_size;
    v_length = length(along);
    vec2 side = v_length > 1e-6 ? vec2(-along.y, along.x) / v_length : vec2(1.0, 0.0);
    v_across = (float(gl_VertexID & 1) * 2.0 - 1.0) * (0.5 * u_width + 1.0);
    gl_Position = gl_VertexID < 2 ? a : b;
    gl_Position.xy += side * v_across * 2.0 / u_size * gl_Position.w;
    gl_Position.z = clamp(gl_Position.z, -gl_Position.w, gl_Position.w); // what is drawn nearer is not cut off
}
