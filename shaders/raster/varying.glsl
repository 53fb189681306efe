// What is interpolated over triangles. Where surfaces are drawn it comes from the vertex shader. DEFERRED: they are
// shaded over the screen, and raster/deferred.glsl finds it.
#ifndef DEFERRED
#define DEFERRED 0
#endif
#if DEFERRED
#define VARYING
#define IS_FRONT deferred_front
// What the neighbour has may be no number where it shows another surface or none.
#define D_DX(value) mix(vec3(0.0), dFdx(value), bvec3(deferred_alike.x))
#define D_DY(value) mix(vec3(0.0), dFdy(value), bvec3(deferred_alike.y))
bool deferred_front;
float deferred_footprint; // length of a pixel on the surface, along x and along y together
vec3 deferred_face; // perpendicular to the triangle, on its front
bvec2 deferred_alike; // whether the neighbour along x, along y of the quad shows the same surface
#else
#define VARYING in
#define IS_FRONT gl_FrontFacing
// A neighbour beyond the horizon of the triangle's plane has what is behind the eye: its 1 / w is negative there.
#define D_DX(value) mix(vec3(0.0), dFdx(value), bvec3(abs(dFdx(gl_FragCoord.w)) < gl_FragCoord.w))
#define D_DY(value) mix(vec3(0.0), dFdy(value), bvec3(abs(dFdy(gl_FragCoord.w)) < gl_FragCoord.w))
#endif
