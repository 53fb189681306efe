// What leaves a yarn's layer of fibres after it met one of them, from the table of viewer/bake/yarn.py: mirrored, for
// fibres that mirror all light; or having entered it (entered.glsl), for white fibres that mirror none.
#include "bsdf/constants.glsl"

const int YARN_AZIMUTHS = 16, YARN_COSINES = 24, YARN_SLICES = 12; // for each yarn; SLICES, AZIMUTHS, COSINES there

// `slice` is the place among the slices of both yarns, `axis` the fibres' direction; w may lie on either side.
vec2 once_shares(sampler2D table, float slice, vec3 axis, vec3 w) {
    float sign_of_both = (axis.z < 0.0) == (w.z < 0.0) ? 1.0 : -1.0;
    float lengths = sqrt(dot(axis.xy, axis.xy) * dot(w.xy, w.xy));
    float azimuth = acos(clamp(sign_of_both * dot(axis.xy, w.xy) / max(lengths, 1e-20), -1.0, 1.0)) * INV_PI;
    float first = min(floor(slice), float(2 * YARN_SLICES - 2)), rows = float(2 * YARN_SLICES * YARN_AZIMUTHS + 1);
    float column = sqrt(min(abs(w.z), 1.0)) * float(YARN_COSINES - 1) + 0.5;
    float row = first * float(YARN_AZIMUTHS) + azimuth * float(YARN_AZIMUTHS - 1) + 0.5;
    // Of this slice and of the next
    vec4 found = textureLod(table, vec2(column / float(YARN_COSINES), row / rows), 0.0);
    return mix(found.xy, found.zw, slice - first);
}

// Over all directions: the greatest sums of the share that goes straight on and of either of these; their means
vec4 once_statistics(sampler2D table, float slice) {
    int first = min(int(slice), 2 * YARN_SLICES - 2), row = 2 * YARN_SLICES * YARN_AZIMUTHS;
    return mix(texelFetch(table, ivec2(first, row), 0), texelFetch(table, ivec2(first + 1, row), 0),
               slice - float(first));
}
