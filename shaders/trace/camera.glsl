// Camera rays in tracer space, from numbers of viewer/trace/paths/camera_rays.py.
uniform vec2 u_camera_pixel; // size of a pixel in normalised device coordinates
uniform mat3 u_camera_ray;   // (x, y, 1) in those to a direction whose part along the view is 1
uniform mat3 u_camera_plane; // likewise to the point where the ray meets a plane across the view, near the scene
uniform float u_camera_depth; // how far that plane is in front of the eye; endless for an orthographic camera
uniform vec3 u_camera_eye;
uniform vec3 u_camera_forward; // 0 for a perspective camera
uniform float u_camera_unit;   // world units in one of tracer space

// `pixel` counts from the picture's lower left corner; a pixel's middle is at a half. The origin is the eye, or where
// that is far away a point of the ray in front of all that |p| <= 1 holds, so that float32 has small numbers to carry.
void camera_ray(vec2 pixel, out vec3 o, out vec3 d) {
    vec3 ndc = vec3(pixel * u_camera_pixel - 1.0, 1.0);
    vec3 ray = u_camera_ray * ndc;
    vec3 p = u_camera_plane * ndc;
    float per_depth = length(ray);
    d = ray / per_depth;
    o = p - min(dot(p, d) + 2.0, u_camera_depth * per_depth) * d;
}

// From the eye to p, or to its plane if the camera is orthographic, in world units.
float camera_distance(vec3 p) {
    vec3 from_eye = p - u_camera_eye;
    return u_camera_unit * (u_camera_forward == vec3(0.0) ? length(from_eye) : dot(from_eye, u_camera_forward));
}
