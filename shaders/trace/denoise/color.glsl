// The factor that light is divided by before the filter and multiplied by after it: the albedo of the first hit, but at
// least 0.04, since a black dielectric reflects that much. `albedo` has the sum over the hits, and in w their number.
vec3 demodulation(vec4 albedo) {
    return albedo.w > 0.0 ? max(albedo.rgb / albedo.w, 0.04) : vec3(1.0);
}
