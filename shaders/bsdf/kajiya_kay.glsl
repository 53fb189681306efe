// Phong's model for a thin cylinder: Kajiya and Kay 1989, "Rendering Fur with Three Dimensional Textures". Light from
// the inclination theta_i, which is the angle to the plane across the cylinder, leaves at all azimuths alike.
#include "bsdf/constants.glsl"

// Diffuse: f cos theta_i = k_d cos theta_i / pi^2. The integral of cos theta_i over all directions is pi^2.
float f_kajiya_kay_diffuse() {
    return INV_PI * INV_PI;
}

// Highlight: f = N cos^s(theta_i + theta_o), about the cone where theta_i = -theta_o. It reflects all light at
// theta_o = 0 if N = 1 / (2 pi B), with B the integral of cos^(s + 2): pi / 2 at s = 0 and sqrt(2 pi / (s + 2.5)) for
// large s. sqrt(2 pi / (s + 2.54648)), which is pi / 2 at s = 0, too, is within 0.3 % in between.
float f_kajiya_kay(vec2 theta_i, vec2 theta_o, float shininess) { // cosine and sine of each
    float cosine = theta_i.x * theta_o.x - theta_i.y * theta_o.y;
    if (cosine <= 0.0) return 0.0;
    return pow(cosine, shininess) * sqrt((shininess + 2.54648) * (0.5 * INV_PI)) * (0.5 * INV_PI);
}
