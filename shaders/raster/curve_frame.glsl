// How a curve lies at a point as the viewer sees it.
#include "raster/curve_point.glsl"
#if IS_ORTHOGRAPHIC
uniform vec3 u_view_direction; // towards the eye
#endif

struct CurveFrame {
    mat3 axes; // along the curve; to the side where `across` grows; across it, to the front
    float sine; // of the angle between the line of sight and the plane across the curve
    float cosine;
};

CurveFrame curve_frame(CurvePoint at) {
    CurveFrame f;
    vec3 along = at.along;
#if IS_ORTHOGRAPHIC
    vec3 v = u_view_direction;
#else
    vec3 v = -normalize(at.position);
#endif
    f.sine = dot(v, along);
    vec3 front = v - along * f.sine;
    f.cosine = length(front);
    front = f.cosine > 1e-4 ? front / f.cosine : normalize(cross(along, vec3(along.y, along.z, -along.x)));
    f.axes = mat3(along, cross(front, along), front);
    return f;
}
