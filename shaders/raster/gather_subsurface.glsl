// What the pass writes that gathers the light of solids, before raster/spread_subsurface.frag spreads it over them.
layout(location = 1) out vec4 o_position; // w: the instance, from 1
layout(location = 2) out vec4 o_profile;  // s of Burley's profile
uniform float u_instance;
uniform vec3 u_interior_shape;            // s, per eye-relative unit

// What the surface takes from light that leaves it along the normal is given back.
void write_gathered(vec3 radiance, SurfaceView view, float covered) {
    o_color = vec4(radiance / max(interface_entering(view.dielectric, view.dfg), 1e-3), 1.0);
    o_position = vec4(v_position, u_instance);
    o_profile = vec4(u_interior_shape, 0.0);
    drop_uncovered(covered);
}
