// The yarns of a woven cloth: which lies above at a point of a mesh's texture coordinates, and how its fibres run there,
// by Irawan & Marschner 2012, "Specular Reflection from Woven Cloth". Where a yarn lies above it is an arc between the
// yarns that it dips under; the arc is a bent cylinder, about which its fibres are twisted. The cylinder is flat: as high
// as the arcs of the yarns that it crosses leave room for (Hearle & Shanahan 1978, "An Energy Method for Calculations in
// Fabric Mechanics").
#include "bsdf/weave/woven.glsl"

uniform sampler2D u_weave_table; // of mirrored.glsl
uniform ivec2 u_weave_size;    // warp yarns, weft yarns of the draft
uniform vec2 u_weave_density;  // warp yarns per unit of u, weft yarns per unit of v
uniform int u_weave_draft[16]; // for each weft yarn, bits of the warp yarns that lie above
uniform vec2 u_weave_flatness; // height of a yarn over its width, of the warp and the weft
// Of the warp and of the weft: albedo and the share through; specular share and thickness; alpha, twist, bend, width
uniform vec4 u_weave_yarns[6];

int weave_wrapped(int k, int size) {
    k = k % size;
    return k < 0 ? k + size : k;
}

// Whether the warp lies above in a cell; seen from behind, it is the other one.
bool weave_is_warp(ivec2 cell, bool is_front) {
    ivec2 c = ivec2(weave_wrapped(cell.x, u_weave_size.x), weave_wrapped(cell.y, u_weave_size.y));
    return ((u_weave_draft[c.y] >> c.x & 1) == 1) == is_front;
}

// The place along the arc of the yarn that lies above, from -1 to 1; f is the place in the cell from 0 to 1
float weave_along(ivec2 cell, bool is_warp, float f, bool is_front) {
    ivec2 step = is_warp ? ivec2(0, 1) : ivec2(1, 0);
    int size = is_warp ? u_weave_size.y : u_weave_size.x;
    int before = 0, after = 0;
    while (before < size && weave_is_warp(cell - step * (before + 1), is_front) == is_warp) ++before;
    while (after < size && weave_is_warp(cell + step * (after + 1), is_front) == is_warp) ++after;
    return 2.0 * (float(before) + f) / float(before + 1 + after) - 1.0;
}

// The tangent of the angle to the cloth's normal below which light is hidden at `across` from 0 to 1 by the next yarn, a
// round cylinder as high as this one at the distance 2 / width, in radii: the direction that touches it.
float weave_horizon(float across, float width) {
    float height = sqrt(1.0 - across * across), ahead = 2.0 / width - across;
    float beside = inversesqrt(max(ahead * ahead + height * height - 1.0, 1e-6)), below = height / ahead;
    return (1.0 + beside * below) / max(beside - below, 1e-6);
}

// A yarn that runs along `direction` in the plane, with `side` across it; along and across from -1 to 1; `is_double` if it
// lies over the other one
Woven weave_yarn(bool is_warp, bool is_double, float along, float across, vec3 direction, vec3 side) {
    int k = is_warp ? 0 : 3;
    vec4 scattered = u_weave_yarns[k], mirrored = u_weave_yarns[k + 1], shape = u_weave_yarns[k + 2];
    const vec3 n = vec3(0.0, 0.0, 1.0);
    across = clamp(across, -0.995, 0.995); // at the very edge nothing would be seen
    float bend = -along * shape.z;
    vec3 tangent = cos(bend) * direction + sin(bend) * n, up = cos(bend) * n - sin(bend) * direction;
    float flatness = is_warp ? u_weave_flatness.x : u_weave_flatness.y;
    float cosine = sqrt(1.0 - across * across); // across is the sine about the cylinder, before it is pressed flat
    vec3 axis = normalize(cos(shape.y) * tangent + sin(shape.y) * (cosine * side - across * flatness * up));
    float rise = sin(min(shape.z + abs(shape.y), 0.5 * PI)); // max_rise of viewer/bake/yarn.py
    float slice = (is_warp ? 0.0 : float(YARN_SLICES))
                + min(abs(axis.z) / max(rise, 1e-6), 1.0) * float(YARN_SLICES - 1);
    vec4 below = is_double ? u_weave_yarns[3 - k] : vec4(0.0, 0.0, 0.0, 1.0);
    return Woven(axis, normalize(cosine * up + across * flatness * side), shape.x, mirrored.w, mirrored.rgb, scattered.rgb,
                 scattered.w, below.rgb, below.w, slice, weave_horizon(abs(across), shape.w) / flatness, vec2(-1.0));
}

// Between yarns, at `across` of the warp and the weft, above 1, in radii of each: light passes that does not meet their
// cylinders. Light that does is scattered as the nearer yarn does.
Woven weave_gap(vec2 across, vec2 dv) {
    vec3 warp = vec3(normalize(dv), 0.0);
    Woven m = weave_yarn(across.x < across.y, false, 0.0, 0.0, warp, vec3(-warp.y, warp.x, 0.0));
    m.axis = warp;
    m.gap = sqrt(max(across * across - 1.0, 0.0)) / u_weave_flatness;
    return m;
}

// The cloth at texture coordinates; du and dv, unit vectors in the plane, are where these grow.
Woven weave_at(vec2 uv, vec2 du, vec2 dv, bool is_front) {
    vec2 place = uv * u_weave_density;
    ivec2 cell = ivec2(floor(place));
    vec2 f = place - floor(place), across = (2.0 * f - 1.0) / vec2(u_weave_yarns[2].w, u_weave_yarns[5].w);
    bool is_warp = weave_is_warp(cell, is_front);
    for (int k = 0; k < 2; ++k) { // the yarn above, then, beside it, the one below
        float at = is_warp ? across.x : across.y;
        if (abs(at) <= 1.0) {
            float along = k > 0 ? 0.0 : weave_along(cell, is_warp, is_warp ? f.y : f.x, is_front);
            vec3 direction = vec3(is_warp ? dv : du, 0.0), side = vec3(is_warp ? du : dv, 0.0);
            bool is_double = k == 0 && abs(is_warp ? across.y : across.x) <= 1.0;
            return weave_yarn(is_warp, is_double, along, at, direction, side);
        }
        is_warp = !is_warp;
    }
    return weave_gap(abs(across), dv);
}
