// A surface shown as it is (KHR_materials_unlit; lines and points without normals).
#include "raster/material.glsl"

void main() {
    vec4 base = base_color();
    write_radiance(base.rgb + emitted(), coverage(base.a));
}
