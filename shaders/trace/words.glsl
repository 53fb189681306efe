// The scene as a texture of words, SCENE_WIDTH a row, four times 32 bits each. Unsigned, for a float texture need not keep the
// bits of what is not a number.
uniform usampler2D u_words;

uvec4 word(int i) {
    return texelFetch(u_words, ivec2(i % SCENE_WIDTH, i / SCENE_WIDTH), 0);
}

vec4 word_float(int i) {
    return uintBitsToFloat(word(i));
}
