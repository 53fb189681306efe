// An upper bound of D for a sun's highlight in a pixel. D at a single half vector is too large if the lobe is narrower
// than the sun, since a reflection is never brighter than the sun. It is also too large if the lobe is narrower than
// the range of slopes within the pixel, since the pixel shows their mean. The bound is
//   D <= 1 / (pi sqrt(det(A + (x x^T + y y^T) / pi))),   det A = (alpha^2 + s^2) (alpha^2 + s^2 / VoH^2)
// It is the mean of GGX over the ellipse of slopes about its peak that a sun of radius 2 s subtends (the form factor of
// an ellipse: D is the flux per area that a point at height alpha sends to the plane). For the parallelogram of x and y
// it is the mean within 12 %. The energy cut off is lost: spreading it over neighbouring pixels would be less exact.
#include "bsdf/constants.glsl"

float max_sun_d(float alpha, float radius2, float VoH, vec3 x, vec3 y) {
    float a2 = alpha * alpha, s2 = 0.25 * radius2;
    float a = PI * sqrt((a2 + s2) * (a2 + s2 / max(VoH * VoH, 1e-8)));
    vec3 area = cross(x, y);
    return inversesqrt(a * a + a * (dot(x, x) + dot(y, y)) + dot(area, area));
}
