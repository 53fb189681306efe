// How bright a sun's highlight can be in a pixel. D at one point is too much where the lobe is narrower than the sun,
// whose reflection is never brighter than the sun, or than the slopes a pixel sees, whose mean is asked for.
//   D <= 1 / (pi sqrt(det(A + (x x^T + y y^T) / pi))),   det A = (alpha^2 + s^2) (alpha^2 + s^2 / VoH^2)
// is GGX's mean over the ellipse of slopes about its peak that a sun of radius 2 s takes (an ellipse's form factor: D is
// what alpha above a plane sends to it per area), and within 12 % that over the parallelogram of x and y. What is cut
// off is lost: spread over the neighbours it would be farther from the truth.
#include "bsdf/constants.glsl"

float most_of_sun(float alpha, float radius2, float VoH, vec3 x, vec3 y) {
    float a2 = alpha * alpha, s2 = 0.25 * radius2;
    float a = PI * sqrt((a2 + s2) * (a2 + s2 / max(VoH * VoH, 1e-8)));
    vec3 area = cross(x, y);
    return inversesqrt(a * a + a * (dot(x, x) + dot(y, y)) + dot(area, area));
}
