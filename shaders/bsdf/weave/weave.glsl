// The yarns of a woven cloth: which lies above at a point of a mesh's texture coordinates, and how its fibres run
// there, by Irawan & Marschner 2012, "Specular Reflection from Woven Cloth". Where a yarn lies above it is an arc
// between the yarns that it dips under; the arc is a bent cylinder, about which its fibres are twisted. The cylinder is
// flat: as high as the arcs of the yarns that it crosses leave room for (Hearle & Shanahan 1978, "An Energy Method for
// Calculations in Fabric Mechanics"), and a lens across: 1 - x^2 high at x from -1 to 1, since these arcs are
// parabolas.
#include "bsdf/weave/woven.glsl"

uniform sampler2D u_weave_table; // of mirrored.glsl
uniform ivec2 u_weave_size;    // warp yarns, weft yarns of the draft
uniform vec2 u_weave_density;  // warp yarns per unit of u, weft yarns per unit of v
// For each cell of the draft, four to an element: bit 0, whether the warp lies above; then, in four bits each, how many
// cells before it and after it along the weft, and along the warp, have the same yarn above
uniform ivec4 u_weave_cells[64];
uniform vec2 u_weave_flatness; // height of a yarn over its width, of the warp and the weft
// Of the warp and of the weft: albedo and the share through; specular share and thickness; alpha, tangent of the twist,
// bend, width; what is left of light that goes through fibres, and max_rise of viewer/bake/yarn.py; what is left of
// light that fibres reflect inside
uniform vec4 u_weave_yarns[10];

// Of the cell with this corner. By floats: what % gives of negative integers is undefined.
int weave_cell(vec2 corner) {
    ivec2 c = min(ivec2(mod(corner + 0.5, vec2(u_weave_size))), u_weave_size - 1);
    int k = c.y * u_weave_size.x + c.x;
    return u_weave_cells[k >> 2][k & 3];
}

// The place along the arc of the yarn that lies above, from -1 to 1; f is the place in the cell from 0 to 1
float weave_along(int cell, bool is_warp, float f) {
    int runs = is_warp ? cell >> 9 : cell >> 1;
    float before = float(runs & 15), after = float(runs >> 4 & 15);
    return 2.0 * (before + f) / (before + 1.0 + after) - 1.0;
}

// The tangent of the angle to the cloth's normal below which light is hidden at x = `across` from 0 to 1 by the next
// yarn, as high as this one, at the distance 2 / width: the line from 1 - x^2 that touches that parabola.
float weave_horizon(float across, float width) {
    float ahead = 2.0 / width - across, x2 = across * across;
    return (ahead + sqrt(ahead * ahead - x2)) / max(2.0 * x2, 1e-6);
}

// A yarn that runs along `direction` in the plane, with `side` across it; along and across from -1 to 1; `is_double` if
// it lies over the other one
Woven weave_yarn(bool is_warp, bool is_double, float along, float across, vec3 direction, vec3 side) {
    int k = is_warp ? 0 : 5;
    vec4 scattered = u_weave_yarns[k], mirrored = u_weave_yarns[k + 1], shape = u_weave_yarns[k + 2];
    const vec3 n = vec3(0.0, 0.0, 1.0);
    float bend = -along * shape.z;
    vec3 tangent = cos(bend) * direction + sin(bend) * n, up = cos(bend) * n - sin(bend) * direction;
    float flatness = is_warp ? u_weave_flatness.x : u_weave_flatness.y;
    float slope = 2.0 * flatness * across; // of the lens
    float cosine = sqrt(max(1.0 - across * across, 0.0)); // of the angle about the yarn, before it is pressed flat
    vec3 axis = normalize(tangent + shape.y * cosine * (side - slope * up));
    float slice = (is_warp ? 0.0 : float(YARN_SLICES))
                + min(abs(axis.z) / max(u_weave_yarns[k + 3].w, 1e-6), 1.0) * float(YARN_SLICES - 1);
    vec4 below = is_double ? u_weave_yarns[5 - k] : vec4(0.0, 0.0, 0.0, 1.0);
    return Woven(axis, normalize(up + slope * side), shape.x, mirrored.w, mirrored.rgb,
                 u_weave_yarns[k + 3].rgb, u_weave_yarns[k + 4].rgb, scattered.rgb, scattered.w, below.rgb, below.w,
                 slice, weave_horizon(abs(across), shape.w) / flatness, vec2(-1.0));
}

// The cloth at texture coordinates; du and dv, unit vectors in the plane, are where these grow. Seen from behind, it is
// the other yarn that lies above. `yarns` is 0 for the warp, 1 for the weft, and 2 more where it lies over the other.
// All cases share one call of weave_yarn, since pixels that are shaded together run the branches of all of them.
Woven weave_at(vec2 uv, vec2 du, vec2 dv, bool is_front, out int yarns) {
    vec2 place = uv * u_weave_density, corner = floor(place);
    vec2 f = place - corner, across = (2.0 * f - 1.0) / vec2(u_weave_yarns[2].w, u_weave_yarns[7].w);
    int cell = weave_cell(corner);
    bvec2 meets = lessThanEqual(abs(across), vec2(1.0)); // the warp, the weft
    bool is_warp = ((cell & 1) == 1) == is_front;
    bool is_gap = !any(meets), is_above = is_warp ? meets.x : meets.y;
    float along = is_above ? weave_along(cell, is_warp, is_warp ? f.y : f.x) : 0.0; // beside it, one is straight
    if (!is_above) is_warp = is_gap ? abs(across.x) < abs(across.y) : !is_warp;
    yarns = (is_warp ? 0 : 1) + (all(meets) ? 2 : 0);
    vec2 direction = is_warp ? dv : du, side = vec2(direction.y, -direction.x); // a screw is one from any direction
    float x = is_gap ? 0.0 : is_warp ? across.x : across.y;
    if (dot(side, is_warp ? du : dv) < 0.0) x = -x;
    Woven m = weave_yarn(is_warp, all(meets), along, x, vec3(direction, 0.0), vec3(side, 0.0));
#if WEAVE_HAS_GAPS
    // Light passes that does not meet the cylinders about the gap; other light is scattered as the nearer yarn does.
    if (is_gap) {
        m.axis = vec3(dv, 0.0);
        m.gap = sqrt(max(across * across - 1.0, 0.0)) / u_weave_flatness;
    }
#endif
    return m;
}
