// What light is divided by before it is filtered, and multiplied by afterwards: the first hit's reflectance, but at
// least that of a common dielectric's surface, which a black one still has. `albedo`: sum, number of hits.
vec3 demodulation(vec4 albedo) {
    return albedo.w > 0.0 ? max(albedo.rgb / albedo.w, 0.04) : vec3(1.0);
}
