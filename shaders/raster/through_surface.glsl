// What is seen through a surface, in the place of what its base would scatter (KHR_materials_transmission).
#include "raster/transmission.glsl"
#if SEES_LAMPS_THROUGH
#include "raster/see_lamps.glsl"
#endif

// `transmitted` is the radiance of the picture behind. The surface keeps what it scatters of the rest.
vec3 through_surface(MaterialInputs m, SurfaceView view, vec3 transmitted, inout Surface s, inout Point p) {
    TRANSMITTANCE throughput = surface_throughput(s, view) * m.transmission;
#if SEES_LAMPS_THROUGH
    see_lamps(m, s, throughput, p);
#endif
#if SHEEN
    transmitted *= view.sheen.throughput;
#endif
    s.base_color *= 1.0 - m.transmission; // the rest is scattered diffusely
#if DIFFUSE_TRANSMISSION
    s.diffuse_transmission_color *= 1.0 - m.transmission;
#endif
    return throughput * entering_tint(m.base_color.rgb) * transmitted * float(SHOW_SPECULAR);
}
