// A shader of one's own: diffuse light in steps, over a rim that grows towards the outline.
#include "bsdf/constants.glsl"
#include "bsdf/fresnel.glsl"

vec3 toon(vec3 color, vec3 n, vec3 l, vec3 v, float steps) {
    float light = ceil(max(dot(n, l), 0.0) * steps) / steps;
    return color * light * INV_PI + 0.5 * pow5(1.0 - max(dot(n, v), 0.0));
}
