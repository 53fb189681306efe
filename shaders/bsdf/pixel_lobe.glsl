// The mean of D over a pixel, for light from one direction: what a highlight that is finer than the pixel is there.
#include "bsdf/constants.glsl"

// x and y are the derivatives of h - n by the pixel's axes. The slopes of h about the pixel's normals are taken to have
// a Gaussian distribution with the covariance sigma^2 (x x^T + y y^T), sigma^2 = 1 / (2 pi) (Tokuyoshi & Kaplanyan
// 2019, "Improved Geometric Specular Antialiasing", eq. 4), and the mean is its convolution with D. For Beckmann's D
// that is another Gaussian, of slopes t = h / NoH - n, with A = alpha^2 + 2 sigma^2 (x x^T + y y^T):
//   exp(-t^T A^-1 t) / (pi sqrt(det A) NoH^4)
// So is what the normals within a texel of a normal map add: `alpha` has it (normal_spread.glsl), and `facet_alpha`, of
// the facets at each of these normals, has not. They are the same where there is no map.
// The mean of GGX is near this close to its peak. Far from it it is GGX itself, facet_alpha^2 / (pi tan^4), and not GGX
// as wide as A, sqrt(det A) / (pi tan^4), by which a lamp with a tiny highlight would light all of the surface around.
// A share facet_alpha^2 / sqrt(det A) of that wider GGX has this tail. Where nothing is added, the mixture is GGX.
//
// alpha = (alpha_t, alpha_b), alpha_t the larger one: a lobe that is stretched along the tangent is an isotropic one of
// alpha_b, convolved with a third spread, along the tangent. On return alpha is as much wider as A is, for the masking.
// facet_alpha is the geometric mean of both.
float d_over_pixel(inout vec2 alpha, float facet_alpha, vec3 tangent, vec3 n, vec3 h, vec3 x, vec3 y) {
    float a2 = alpha.y * alpha.y, area = alpha.x * alpha.y, NoH = max(dot(n, h), 1e-4);
    vec3 t = h / NoH - n, z = tangent * sqrt(max(alpha.x * alpha.x - a2, 0.0) / INV_PI);
    vec3 xxy = cross(x, y), xxz = cross(x, z), yxz = cross(y, z), xxt = cross(x, t), yxt = cross(y, t), zxt = cross(z, t);
    float det = a2 * (a2 + INV_PI * (dot(x, x) + dot(y, y) + dot(z, z)))
        + INV_PI * INV_PI * (dot(xxy, xxy) + dot(xxz, xxz) + dot(yxz, yxz));
    float width = sqrt(det), unspread = a2 * dot(t, t) + INV_PI * dot(zxt, zxt);
    float d = exp(-(unspread + INV_PI * (dot(xxt, xxt) + dot(yxt, yxt))) / det) / width;
#if NDF == 0
    float tail = width + unspread / area;
    d = mix(d, width / (tail * tail), facet_alpha * facet_alpha / width);
#endif
    alpha = min(alpha * sqrt(width / area), 1.0);
    return d * INV_PI / (NoH * NoH * NoH * NoH);
}
