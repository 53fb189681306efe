// Luminance of linear Rec. 709 light (ITU-R BT.709-6, item 3.2).
float luminance(vec3 c) {
    return dot(c, vec3(0.2126, 0.7152, 0.0722));
}
