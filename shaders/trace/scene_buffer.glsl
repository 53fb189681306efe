// The scene buffer: all arrays of the scene in one texture, SCENE_WIDTH texels a row, four times 32 bits each
// (viewer/trace/scene/scene_buffer.py). The texture has unsigned integers, since a float texture need not keep the bits
// of a NaN.
uniform usampler2D u_scene;

uvec4 scene_uint4(int i) {
    uvec2 place = uvec2(uint(i) % uint(SCENE_WIDTH), uint(i) / uint(SCENE_WIDTH)); // faster than with signs
    return texelFetch(u_scene, ivec2(place), 0);
}

vec4 scene_float4(int i) {
    return uintBitsToFloat(scene_uint4(i));
}
