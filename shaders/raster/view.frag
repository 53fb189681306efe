// A view of one quantity of the surfaces, in place of their shading. IS_FLAT: triangles, not lines or points.
#include "raster/material.glsl"
#include "raster/view_value.glsl"
#if SHOW == 1 && HAS_NORMAL
#include "raster/normal.glsl"
#endif

vec3 code_of(MaterialInputs m) {
#if SHOW == 1 && HAS_NORMAL
    return code_of_normal(shading_normal(geometric_normal()));
#elif SHOW == 2 && IS_FLAT
    // Towards the eye, since x grows to the right of the screen and y upwards
    vec3 n = cross(dFdx(v_position), dFdy(v_position));
    return code_of_normal(n * inversesqrt(max(dot(n, n), 1e-36)));
#elif SHOW == 3 && HAS_NORMAL
    return vec3(m.perceptual_roughness);
#elif SHOW == 4 && HAS_NORMAL
    return vec3(m.metallic);
#elif SHOW == 5 && (UV_SETS & 1)
    vec2 uv = mesh_uv(0), square = floor(8.0 * uv);
    return vec3(fract(uv), mod(square.x + square.y, 2.0) * 0.4);
#elif SHOW == 6
    return code_of_depth(v_position);
#else
    return HAS_NONE;
#endif
}

void main() {
    MaterialInputs m = read_inputs();
    float covered = coverage(m.base_color.a);
#if SHOW == 7
    o_color = vec4(1.0);
    drop_uncovered(covered);
#elif SHOW == 0
    write_radiance(clamp(m.base_color.rgb, 0.0, 1.0), covered);
#else
    write_radiance(linear_from_code(clamp(code_of(m), 0.0, 1.0)), covered);
#endif
}
