// What is interpolated over triangles. Where surfaces are drawn it comes from the vertex shader. DEFERRED: they are
// shaded over the screen, and raster/deferred.glsl finds it.
#ifndef DEFERRED
#define DEFERRED 0
#endif
#if DEFERRED
#define VARYING
#define IS_FRONT deferred_front
#define D_DX(value) (dFdx(value) * deferred_alike.x)
#define D_DY(value) (dFdy(value) * deferred_alike.y)
bool deferred_front;
float deferred_footprint; // length of a pixel on the surface, along x and along y together
vec3 deferred_face; // perpendicular to the triangle
vec2 deferred_alike; // 1 where the neighbour along x, along y of the quad shows the same surface, else 0
#else
#define VARYING in
#define IS_FRONT gl_FrontFacing
#define D_DX(value) dFdx(value)
#define D_DY(value) dFdy(value)
#endif
