// The scene buffer: all arrays of the scene in one buffer, whose texels have four times 32 bits
// (viewer/trace/scene/scene_buffer.py). They are unsigned integers, since a float texture need not keep the bits of a
// NaN.
uniform usamplerBuffer u_scene;

uvec4 scene_uint4(int i) {
    return texelFetch(u_scene, i);
}

vec4 scene_float4(int i) {
    return uintBitsToFloat(scene_uint4(i));
}
