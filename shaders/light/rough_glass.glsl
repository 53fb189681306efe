// The factors s by which rough glass loses no light, f(o, i) s(o) s(i), by viewer/bake/rough_glass.py: their logarithms
// are in the second quarter of the DFG table of the path tracer.
const float ROUGHEST = 0.5; // perceptual roughness

// log s for light at `cosine` to the normal, on either side of an interface with this f0, where it is inside or outside
float rough_glass_factor(sampler2D table, float cosine, float alpha, float f0, bool is_inside) {
    vec3 place = 15.0 * vec3(min(sqrt(alpha) / ROUGHEST, 1.0), sqrt(vec2(abs(cosine), sqrt(f0))));
    float layer = min(floor(place.z), 15.0);
    vec2 tile = vec2(mod(layer, 4.0), floor(0.25 * layer));
    vec2 uv = (tile + (place.xy + 0.5) / 16.0) / 4.0;
    vec4 pair = textureLod(table, vec2(uv.x, 0.25 + 0.25 * uv.y), 0.0);
    vec2 side = is_inside ? pair.yw : pair.xz;
    return mix(side.x, side.y, place.z - layer);
}
