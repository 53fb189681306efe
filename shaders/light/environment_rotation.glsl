// An environment that is rotated about +Y.
#if ENVIRONMENT_ROTATED
uniform vec2 u_environment_rotation; // cosine, sine
#endif

// The direction in the environment's map that d is in the world
vec3 to_environment(vec3 d) {
#if ENVIRONMENT_ROTATED
    float c = u_environment_rotation.x, s = u_environment_rotation.y;
    return vec3(c * d.x - s * d.z, d.y, s * d.x + c * d.z);
#else
    return d;
#endif
}
