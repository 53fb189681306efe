// Luminance of linear Rec. 709 light (ITU-R BT.709-6, item 3.2), the weight by which a lobe's part is chosen.
float luminance(vec3 c) {
    return dot(c, vec3(0.2126, 0.7152, 0.0722));
}
