// Surfaces without lighting (KHR_materials_unlit; lines and points without normals).
#include "raster/material.glsl"

void main() {
    MaterialInputs m = read_inputs();
    write_radiance(m.base_color.rgb + m.emissive, coverage(m.base_color.a));
}
