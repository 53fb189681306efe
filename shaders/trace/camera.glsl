// Camera rays in tracer space; viewer/trace/paths/camera_rays.py sets the uniforms.
uniform vec2 u_camera_pixel; // size of a pixel in normalised device coordinates
uniform mat3 u_camera_ray;   // maps (x, y, 1) in these coordinates to a direction whose component along the view is 1
uniform mat3 u_camera_plane; // likewise to the point where the ray crosses a plane near the scene that faces the camera
uniform float u_camera_depth; // distance from the eye to that plane; 1e30 for an orthographic camera
uniform vec3 u_camera_eye;
uniform vec3 u_camera_forward; // 0 for a perspective camera
uniform float u_camera_unit;   // world units in one of tracer space
uniform ivec2 u_camera_skip;   // how many pixels of the view lie between two that are traced, and before the first

// The ray through `pixel`, which counts from the lower left corner of the picture; pixel centres are at a half. The ray
// starts at the eye. If the eye is far away, the ray starts at a nearer point in front of the unit ball that holds the
// scene, or of the ball that holds its fog, so that float32 does not lose digits to a large distance.
void camera_ray(vec2 pixel, out vec3 o, out vec3 d) {
    vec3 ndc = vec3(pixel * u_camera_pixel - 1.0, 1.0);
    vec3 ray = u_camera_ray * ndc;
    vec3 p = u_camera_plane * ndc;
    float per_depth = length(ray);
    d = ray / per_depth;
    o = p - min(dot(p, d) + (HAS_FOG > 0 ? MEDIA_REACH : 2.0), u_camera_depth * per_depth) * d;
}

// The pixel of the view that is pixel p of what is traced, which is all of them or each few'th
ivec2 view_pixel(ivec2 p) {
    return p + u_camera_skip.x * p + u_camera_skip.y;
}

// Distance from the eye to p in world units; for an orthographic camera it is measured along the view.
float camera_distance(vec3 p) {
    vec3 from_eye = p - u_camera_eye;
    return u_camera_unit * (u_camera_forward == vec3(0.0) ? length(from_eye) : dot(from_eye, u_camera_forward));
}
