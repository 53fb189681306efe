// Lines of sight in the space of the points of curves, also of an orthographic camera and of a light.
uniform mat4 u_to_clip;    // from the space of the points
uniform vec2 u_half_size;  // of the picture, in pixels
uniform float u_nearer;    // 1 where z / w grows towards the viewer, else -1

// The direction along which a point moves without moving on the screen, towards the viewer: where the gradients of
// x / w and y / w are 0
vec3 sight(vec3 p, out vec3 gradient_x, out vec3 gradient_y) {
    mat4 rows = transpose(u_to_clip);
    vec4 clip = u_to_clip * vec4(p, 1.0);
    gradient_x = (rows[0].xyz - clip.x / clip.w * rows[3].xyz) / clip.w;
    gradient_y = (rows[1].xyz - clip.y / clip.w * rows[3].xyz) / clip.w;
    vec3 front = normalize(cross(gradient_x, gradient_y));
    vec4 towards = u_to_clip * vec4(front, 0.0);
    return (towards.z * clip.w - clip.z * towards.w) * u_nearer < 0.0 ? -front : front;
}
