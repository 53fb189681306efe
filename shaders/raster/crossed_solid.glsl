// Diffuse transmission through a solid (KHR_materials_diffuse_transmission with KHR_materials_volume).

// A solid is taken for a slab. Light enters either side with t color, a of it is not absorbed on its way across, and
// each side returns (1 - t) rho of it. With r = (1 - t) rho a, the inside of a side gets t color a / (1 - r^2) of the
// light that falls on the other side, and r times as much of its own: t color a / (1 - r) in all, r / (1 + r) of it its
// own.
vec3 crossed_solid(Surface s, vec3 a, out vec3 own) {
    vec3 r = min((1.0 - s.diffuse_transmission) * s.base_color * a, 0.999);
    own = r / (1.0 + r);
    return s.diffuse_transmission * s.diffuse_transmission_color * a / (1.0 - r);
}
