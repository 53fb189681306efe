// Direction to equirectangular texture: u = 1/2 + atan2(z, x) / 2 pi, v = acos(y) / pi, v = 0 the top row.

// atan2(z, x) in turns, -1/2 .. 1/2, by an odd polynomial on one octant. Its error is below 1e-4 rad, a sixtieth of a
// texel of a map 1024 texels wide. At the poles, where x = z = 0, it is 0.
float turns(float z, float x) {
    float ax = abs(x), az = abs(z);
    float t = min(ax, az) / max(max(ax, az), 1e-20);
    float t2 = t * t;
    float a = t * (0.15902981 - t2 * (0.05111656 - t2 * (0.02327866 - t2 * 0.00620486)));
    a = az > ax ? 0.25 - a : a;
    a = x < 0.0 ? 0.5 - a : a;
    return z < 0.0 ? -a : a;
}

// acos(y) / pi. The factor sqrt(1 - |y|) has the infinite slope at the poles (as in Abramowitz & Stegun 4.4.45). The
// error is below 4e-5 rad.
float colatitude(float y) {
    float a = min(abs(y), 1.0);
    float c = sqrt(1.0 - a) * (0.49998793 + a * (-0.06776048 + a * (0.02447766 + a * -0.00665043)));
    return y < 0.0 ? 1.0 - c : c;
}

// d: unit length
vec2 equirect_uv(vec3 d) {
    return vec2(0.5 + turns(d.z, d.x), colatitude(d.y));
}

// The same for a map with a margin beyond each pole, of 1/32 of its height: see viewer/bake/prefilter.py.
vec2 equirect_uv_with_margin(vec3 d) {
    vec2 uv = equirect_uv(d);
    return vec2(uv.x, uv.y * 0.9375 + 0.03125);
}
