// How much wider a lobe is than the facets of its texel make it: normals that differ within a pixel widen it.
#if SPECULAR_AA
#include "bsdf/specular_aa.glsl"
#endif
#if NORMAL_MAP || CLEARCOAT_NORMAL_MAP
#include "bsdf/normal_spread.glsl"
#endif
#if GROOVED
#include "bsdf/grooves.glsl"
uniform sampler2D u_normal_root; // of the covariance of the map's normals

vec3 normal_root() {
    return map_texel(u_normal_root, NORMAL_UV, NORMAL_TRANSFORM, u_normal_transform, NORMAL_MIRROR).xyz;
}
#endif

// Widens the lobe of the surface, alike in all directions.
void widen_lobe(inout Surface s, inout Point p) {
#if LIGHT_COUNT > 0
    p.facet_alpha = mean_alpha(s);
#endif
#if NORMAL_MAP && HAS_TANGENT && !GROOVED
    s.alpha = widened_alpha(s.alpha, normal_texel(), u_normal_scale);
    s.alpha_t = widened_alpha(s.alpha_t, normal_texel(), u_normal_scale);
#endif
#if LIGHT_COUNT > 0
    p.alphas = both_alphas(s);
#endif
#if SPECULAR_AA
    s.alpha = alpha_antialiased(s.alpha, D_DX(p.n), D_DY(p.n));
    s.alpha_t = alpha_antialiased(s.alpha_t, D_DX(p.n), D_DY(p.n));
#endif
}

#if CLEARCOAT
// alpha of the clear coat, whose normal is n
float coat_alpha(Surface s, vec3 n, inout Point p) {
    float alpha = s.coat_alpha;
#if LIGHT_COUNT > 0
    p.coat_facet_alpha = alpha;
#endif
#if CLEARCOAT_NORMAL_MAP && HAS_TANGENT
    alpha = widened_alpha(alpha, clearcoat_normal_texel(), u_clearcoat_normal_scale);
#endif
#if LIGHT_COUNT > 0
    p.coat_alpha = alpha;
#endif
#if SPECULAR_AA
    alpha = alpha_antialiased(alpha, D_DX(n), D_DY(n));
#endif
    return alpha;
}
#endif

#if GROOVED
// Stretches the lobe as a map full of grooves does. Texels do not hide each other as facets do: what they reflect
// together is what each of them would, `albedo` (a, b of the split sum) before the lobe is stretched.
void stretch_over_grooves(inout Surface s, inout SurfaceView view, inout Point p, vec2 albedo) {
#if LIGHT_COUNT > 0
    mat3 frame = p.frame;
    stretch_lobe(p.alphas, frame, normal_texel().xyz, normal_root(), u_normal_scale, map_axes());
#endif
    vec2 alphas = both_alphas(s);
    stretch_lobe(alphas, p.frame, normal_texel().xyz, normal_root(), u_normal_scale, map_axes());
    s.alpha_t = alphas.x;
    s.alpha = alphas.y;
    view.perceptual_roughness = table_roughness(s);
    vec2 hiding = facet_albedo(s, p.v * p.frame, view.perceptual_roughness, u_dfg);
    p.unhidden = clamp((albedo.x + albedo.y) / max(hiding.x + hiding.y, 1e-3), 1.0, 2.0);
}
#endif
