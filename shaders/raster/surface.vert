// The vertices of meshes.
#include "raster/surface_vertex.glsl"

void main() {
    transform_vertex();
}
