// Where a mesh stands, and how its normals turn: as the draw has it, or each of the instances that one call draws.
// viewer/raster/instances.py has their attributes, the columns of their matrices.
#if INSTANCED
in vec3 a_model_x, a_model_y, a_model_z, a_model_w;

mat4 model_matrix() {
    return mat4(vec4(a_model_x, 0.0), vec4(a_model_y, 0.0), vec4(a_model_z, 0.0), vec4(a_model_w, 1.0));
}

#if HAS_NORMAL
in vec3 a_normal_x, a_normal_y, a_normal_z;

mat3 normal_matrix() {
    return mat3(a_normal_x, a_normal_y, a_normal_z);
}
#endif
#else
uniform mat4 u_model;         // mesh to eye-relative space
uniform mat3 u_normal_matrix; // its inverse transpose, up to scale

mat4 model_matrix() {
    return u_model;
}

#if HAS_NORMAL
mat3 normal_matrix() {
    return u_normal_matrix;
}
#endif
#endif
