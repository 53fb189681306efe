// Vertex attributes of a fragment, and the texture coordinates of its maps. A map M is read with the UV set M_UV, which
// u_M_transform transforms if M_TRANSFORM is 1 (KHR_texture_transform). M_MIRROR has a bit each for mirrored repetition
// along s and t. UV_SETS has a bit for each UV set that the program reads.
#include "raster/varying.glsl"
#if HAS_COLOR
in vec4 v_color;
#endif
#if UV_SETS & 1
VARYING vec2 v_uv0;
#if DEFERRED
mat2 deferred_uv0_slope; // derivatives by the pixel's x and y
#endif
#endif
#if UV_SETS & 2
VARYING vec2 v_uv1;
#if DEFERRED
mat2 deferred_uv1_slope;
#endif
#endif

vec2 mesh_uv(int uv_set) {
#if UV_SETS == 3
    return uv_set == 0 ? v_uv0 : v_uv1;
#elif UV_SETS == 2
    return v_uv1;
#elif UV_SETS == 1
    return v_uv0;
#else
    return vec2(0.0);
#endif
}

vec2 map_uv(int uv_set, int is_transformed, mat3x2 transform, int mirror) {
    vec2 uv = mesh_uv(uv_set);
    if (is_transformed != 0) uv = transform * vec3(uv, 1.0);
    vec2 folded = 1.0 - abs(mod(uv, 2.0) - 1.0);
    return vec2((mirror & 1) != 0 ? folded.x : uv.x, (mirror & 2) != 0 ? folded.y : uv.y);
}

#if DEFERRED
mat2 uv_slope(int uv_set) {
#if UV_SETS == 3
    return uv_set == 0 ? deferred_uv0_slope : deferred_uv1_slope;
#elif UV_SETS == 2
    return deferred_uv1_slope;
#elif UV_SETS == 1
    return deferred_uv0_slope;
#else
    return mat2(0.0);
#endif
}
#endif

vec4 map_texel(sampler2D map, int uv_set, int is_transformed, mat3x2 transform, int mirror) {
    vec2 uv = map_uv(uv_set, is_transformed, transform, mirror);
#if DEFERRED // a quad may show several surfaces
    mat2 slope = uv_slope(uv_set);
    if (is_transformed != 0) slope = mat2(transform) * slope;
    return textureGrad(map, uv, slope[0], slope[1]);
#else
    return texture(map, uv);
#endif
}
