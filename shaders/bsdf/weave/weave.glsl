// The yarns of a woven cloth: which lies above at a point of a mesh's texture coordinates, and how its fibres run there,
// by Irawan & Marschner 2012, "Specular Reflection from Woven Cloth". Where a yarn lies above it is an arc between the
// yarns that it dips under; the arc is a bent cylinder, about which its fibres are twisted.
#include "bsdf/weave/woven.glsl"

uniform ivec2 u_weave_size;    // warp yarns, weft yarns of the draft
uniform vec2 u_weave_density;  // warp yarns per unit of u, weft yarns per unit of v
uniform int u_weave_draft[16]; // for each weft yarn, bits of the warp yarns that lie above
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

// A yarn that runs along `direction` in the plane, with `side` across it; along and across from -1 to 1
Woven weave_yarn(bool is_warp, float along, float across, vec3 direction, vec3 side) {
    int k = is_warp ? 0 : 3;
    vec4 scattered = u_weave_yarns[k], mirrored = u_weave_yarns[k + 1], shape = u_weave_yarns[k + 2];
    const vec3 n = vec3(0.0, 0.0, 1.0);
    float bend = -along * shape.z;
    vec3 tangent = cos(bend) * direction + sin(bend) * n, up = cos(bend) * n - sin(bend) * direction;
    float cosine = sqrt(max(1.0 - across * across, 0.0)); // across is the sine about the cylinder
    vec3 axis = cos(shape.y) * tangent + sin(shape.y) * (cosine * side - across * up);
    return Woven(normalize(axis), normalize(cosine * up + across * side), shape.x, mirrored.w, mirrored.rgb, scattered.rgb, scattered.w);
}

// The cloth at texture coordinates; du and dv, unit vectors in the plane, are where these grow.
Woven weave_at(vec2 uv, vec2 du, vec2 dv, bool is_front) {
    vec2 place = uv * u_weave_density;
    ivec2 cell = ivec2(floor(place));
    vec2 f = place - floor(place);
    bool is_warp = weave_is_warp(cell, is_front);
    for (int k = 0; k < 2; ++k) { // the yarn above, then, beside it, the one below
        float across = is_warp ? 2.0 * f.x - 1.0 : 2.0 * f.y - 1.0;
        across /= u_weave_yarns[is_warp ? 2 : 5].w;
        if (abs(across) <= 1.0) {
            float along = k > 0 ? 0.0 : weave_along(cell, is_warp, is_warp ? f.y : f.x, is_front);
            vec3 direction = vec3(is_warp ? dv : du, 0.0), side = vec3(is_warp ? du : dv, 0.0);
            return weave_yarn(is_warp, along, across, direction, side);
        }
        is_warp = !is_warp;
    }
    return Woven(vec3(1.0, 0.0, 0.0), vec3(0.0, 0.0, 1.0), 1.0, 0.0, vec3(0.0), vec3(0.0), 0.0); // a gap
}
