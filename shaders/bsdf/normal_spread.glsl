// The alpha of a lobe over all the normals that a texel of a mip level is the mean m of. The texel's alpha tells how
// far their x and y spread (viewer/scene/normal_spread.py): s^2 = 2 sqrt(det covariance). alpha^2 gains as much for
// slopes about the mean normal. These areas are s^2 / |m|^2 times those of the ways there: from x, y of unit normals to
// slopes, 1 / z^4; k^2 for the scale k; and from slopes to the plane across the scaled normal, z_k^3. All is s^2 k^2
// |m|^2 / (m.z |m_k|^3).
float widened_alpha(float alpha, vec4 texel, float scale) {
    vec3 m = texel.xyz * (255.0 / 127.5) - 1.0;
    float s = 1.0 - texel.a;
    float scaled = length(vec3(m.xy * scale, m.z));
    float gain = s * s * dot(m, m) / max(m.z * scaled, 1e-4) * pow(scale / max(scaled, 1e-4), 2.0);
    return sqrt(min(alpha * alpha + gain, 1.0));
}
