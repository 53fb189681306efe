// Surfaces without lighting (KHR_materials_unlit; lines and points without normals).
#include "raster/material.glsl"
#if DEFERRED
#include "raster/deferred.glsl"
#endif

void main() {
#if DEFERRED
    find_surface();
#endif
    MaterialInputs m = read_inputs();
    write_radiance(m.base_color.rgb + m.emissive, coverage(m.base_color.a));
}
