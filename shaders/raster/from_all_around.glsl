// What a solid shows, on each of its sides, of the mean light on all of them (raster/interior.glsl).

// The share of this light that leaves the surface towards the eye
vec3 from_all_around(Point p, Surface s, SurfaceView view) {
    vec3 shown = p.everywhere * float(SHOW_DIFFUSE);
    return MIX_METAL(s, interface_entering(view.dielectric, view.dfg) * shown, vec3(0.0));
}
