// Light of lamps that comes to a fibre through others, for curve_light.glsl.

uniform sampler3D u_hair_depths; // optical depth to each light, one grid above the other along z
uniform float u_hair_spread;     // variance of the angle by which a fibre turns light about it that goes through

// Light that comes through the fibres which hide it almost straight on
struct ThroughFibres {
    vec3 share;    // of the light that meets at least one of them
    float crossed; // how many it has gone through, in the mean
};

// Fibres on the way of light i are Poisson distributed about the depth d. Light that meets none has the share exp(-d),
// and of all light exp(-d kept) comes. The number that this has gone through is Poisson distributed, too, about
// x = d (1 - kept), and x / (1 - exp(-x)) of those that are not 0.
ThroughFibres light_through_fibres(int i, vec3 position) {
    float margin = 0.5 * float(LIGHT_COUNT) / float(textureSize(u_hair_depths, 0).z);
    vec3 at = in_hair(position);
    at.z = (clamp(at.z, margin, 1.0 - margin) + float(i)) / float(LIGHT_COUNT);
    float depth = max(textureLod(u_hair_depths, at, 0.0).r, 1e-4);
    vec3 x = depth * (1.0 - u_hair_kept);
    float mean = max(dot(x, vec3(1.0 / 3.0)), 1e-6);
    vec3 share = exp(-depth * u_hair_kept) * one_minus_exp(x);
    return ThroughFibres(share / one_minus_exp(depth), mean / one_minus_exp(mean));
}

// As fibre_response, for light that comes from wi through other fibres. Each has spread it as its lobe TT does, along
// the fibre and about it, and has turned it by the tilt of its scales. This is global multiple scattering of Zinke et
// al. 2008, "Dual Scattering Approximation for Fast Multiple Scattering in Hair". About the fibre two directions stand
// for all, one standard deviation to either side.
vec3 response_through_fibres(SeenFibre s, vec3 wi, float crossed) {
    float tilt = crossed * s.fibre.tilt, off = min(sqrt(crossed * u_hair_spread), 0.5 * PI);
    vec2 theta = complex_product(vec2(length(wi.yz), wi.x), vec2(cos(tilt), sin(tilt)));
    theta.x = abs(theta.x);
    vec4 variance = s.lobes.variance + crossed * s.lobes.variance.y, along;
    for (int p = 0; p < 4; ++p) along[p] = longitudinal(theta, s.lobes.mean[p], variance[p]);
    float phi = atan(abs(wi.y), wi.z), farther = phi + off;
    mat3x4 lobes = far_lobes(s, abs(phi - off)) + far_lobes(s, min(farther, 2.0 * PI - farther));
    return along * lobes * 0.5;
}
