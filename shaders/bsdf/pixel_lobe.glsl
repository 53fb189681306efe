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
// On return `alpha` is that of an isotropic lobe as wide as A, for the masking.
float d_over_pixel(inout float alpha, float facet_alpha, vec3 n, vec3 h, vec3 x, vec3 y) {
    float a2 = alpha * alpha, NoH = max(dot(n, h), 1e-4);
    vec3 t = h / NoH - n, xxy = cross(x, y), xxt = cross(x, t), yxt = cross(y, t);
    float det = a2 * (a2 + INV_PI * (dot(x, x) + dot(y, y))) + INV_PI * INV_PI * dot(xxy, xxy), width = sqrt(det);
    float d = exp(-(a2 * dot(t, t) + INV_PI * (dot(xxt, xxt) + dot(yxt, yxt))) / det) / width;
#if NDF == 0
    float tail = width + dot(t, t);
    d = mix(d, width / (tail * tail), facet_alpha * facet_alpha / width);
#endif
    alpha = min(sqrt(width), 1.0);
    return d * INV_PI / (NoH * NoH * NoH * NoH);
}
