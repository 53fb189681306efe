// Woven cloth: the yarns of bsdf/weave. Light goes straight on between them.
#define TRANSMITS 1
#define REFRACTS 0
#define GUIDED 0
#define WEAVE_HAS_GAPS 1
#include "bsdf/weave/weave.glsl"
#if ANISOTROPIC
#include "bsdf/anisotropy.glsl"
#endif
#include "trace/emission.glsl"
#include "trace/state.glsl"

struct Bsdf {
    Woven woven;
    WovenView view;
};

mat3 shading_frame(Interaction i, MaterialInputs m); // of trace/surface_sides.glsl

// Where the texture coordinates grow, in the frame of the shading normal: the derivatives of the position by them
void weave_directions(Triangle tri, mat3 frame, out vec2 du, out vec2 dv) {
    vec4 p0 = scene_float4(tri.corners.x), p1 = scene_float4(tri.corners.y), p2 = scene_float4(tri.corners.z);
    vec2 v = vec2(scene_float4(tri.corners.y + 1).w, scene_float4(tri.corners.z + 1).w)
           - scene_float4(tri.corners.x + 1).w;
    vec2 u = vec2(p1.w, p2.w) - p0.w;
    mat3 to_frame = mat3(tri.row0.xyz, tri.row1.xyz, tri.row2.xyz);
    vec3 e1 = (p1.xyz - p0.xyz) * to_frame * frame, e2 = (p2.xyz - p0.xyz) * to_frame * frame;
    float hand = u.x * v.y - u.y * v.x < 0.0 ? -1.0 : 1.0;
    du = hand * (e1 * v.y - e2 * v.x).xy;
    dv = hand * (e2 * u.x - e1 * u.y).xy;
    du *= inversesqrt(max(dot(du, du), 1e-30));
    dv *= inversesqrt(max(dot(dv, dv), 1e-30));
}

Bsdf bsdf_at(Interaction i, SurfaceMaterial m, vec3 wo, vec3 n_coat) {
    Triangle tri = find_triangle(unpack_hit(texelFetch(u_hit, source_of(ivec2(gl_FragCoord.xy)), 0)));
    vec2 du, dv;
    weave_directions(tri, shading_frame(i, m.inputs), du, dv);
    Bsdf b;
    int yarns;
    b.woven = weave_at(i.uv0, du, dv, i.is_front, yarns);
    b.view = woven_view(b.woven, wo, u_weave_table);
    return b;
}

vec4 bsdf_eval_pdf(Bsdf b, vec3 wo, vec3 wi) {
    return woven_eval_pdf(b.woven, b.view, wo, wi, u_weave_table);
}

BsdfSample bsdf_sample(Bsdf b, vec3 wo, vec3 u, out float worth) {
    worth = 1.0;
    return woven_sample(b.woven, b.view, wo, u, u_weave_table);
}

#include "trace/shade.glsl"
