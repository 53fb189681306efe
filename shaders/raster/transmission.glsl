// Transmitted light in screen space: the picture of what is behind, in levels of growing blur for rough glass
// (viewer/raster/transmission.py). KHR_materials_transmission, KHR_materials_volume.
// IS_SOLID: light is refracted at the front of a solid; else the surface is thin-walled, and light goes straight on.
#include "raster/material.glsl"
#include "raster/backdrop.glsl"
#if TRACED_REFRACTION
#include "raster/traced_refraction.glsl"
#endif
#if HAS_ENVIRONMENT
#include "raster/environment.glsl"
#endif
#if DISPERSIVE
#include "bsdf/dispersion.glsl"
#endif

// Roughness of the transmitted lobe. It grows with the difference of the indices, from 0 at ior 1 to that of the
// reflected lobe at 1.5, as in the glTF Sample Renderer.
float transmitted_roughness(float perceptual_roughness, float ior) {
    return perceptual_roughness * clamp(2.0 * ior - 2.0, 0.0, 1.0);
}

#if IS_SOLID
// Mean curvature of the surface, 1 / r on a sphere, from the differences of normals n and positions p between pixels
float curvature(vec3 n, vec3 p) {
    vec3 nx = dFdx(n), ny = dFdy(n), px = dFdx(p), py = dFdy(p);
    return (dot(nx, px) + dot(ny, py)) / max(dot(px, px) + dot(py, py), 1e-18);
}

// The direction of a view ray after it has left the solid, having travelled `thickness` along d inside. The far side is
// unknown, and is guessed from the front. Behind a flat front it is a parallel plane, behind a hollow one a concentric
// surface. Behind a round front it turns from that plane to the other half of a sphere, as the thickness grows to the
// chord 2 (-n.d) / curved. The light never meets it at a larger angle than the front, so that it always leaves.
vec3 leaving_direction(vec3 n, float curved, vec3 d, float thickness, float ior) {
    float cosine = max(-dot(n, d), 1e-3), turn = min(curved * thickness, 2.0 * cosine);
    vec3 out_n = turn < 0.0 ? n + turn * d : (1.0 - turn / cosine) * n - turn * d;
    return refract(d, normalize(out_n), ior);
}
#endif

// The base colour tints transmitted light once. Traced paths apply its square root here and again where they leave.
vec3 entering_tint(vec3 base_color) {
#if TRACED_REFRACTION
    return sqrt(max(base_color, vec3(0.0)));
#else
    return base_color;
#endif
}

// The radiance seen through the surface if its index is `ior`. Where the picture shows nothing, and outside of it, the
// environment is used. `curved` is the curvature of a solid.
vec3 seen_through(MaterialInputs m, float ior, vec3 n, vec3 n_geometric, vec3 v, float curved, float blur) {
    vec3 exit = v_position, d = -v; // where the light leaves the solid, and its direction seen from the eye
    vec3 transmittance = vec3(1.0);
#if IS_SOLID
    d = refract(-v, n, 1.0 / ior);
    exit += m.thickness * d; // eye-relative units
    transmittance = exp(-u_absorption * m.thickness);
    d = leaving_direction(n_geometric, curved, d, m.thickness, ior);
#endif
    vec4 behind = backdrop_at(exit, blur);
    vec3 unseen = vec3(0.0); // radiance of what the picture does not have
#if HAS_ENVIRONMENT
    unseen = environment_specular(d, blur);
#endif
#if MEDIA && IS_SOLID // solids are drawn before the media that have nothing behind them
    Haze haze = haze_at(1e18);
    unseen = haze.light + haze.transmittance * unseen;
#endif
    behind.rgb += (1.0 - behind.a) * unseen;
#if MEDIA
    behind.rgb = beyond_media(behind.rgb, v_position);
#endif
    return transmittance * behind.rgb;
}

// The transmitted radiance; of dispersive glass by an index for each of red, green and blue
vec3 transmitted_light(MaterialInputs m, vec3 n, vec3 n_geometric, vec3 v, float blur) {
    float curved = 0.0;
#if IS_SOLID
    curved = curvature(n_geometric, v_position); // derivatives are undefined after a fragment returns
#endif
#if TRACED_REFRACTION
    vec4 traced = traced_light(u_refracted, n_geometric);
    if (traced.a >= 0.0) return traced.rgb;
#endif
#if DISPERSIVE
    vec3 ior = ior_of_bands(m.ior, m.dispersion);
    return vec3(seen_through(m, ior.r, n, n_geometric, v, curved, blur).r,
                seen_through(m, ior.g, n, n_geometric, v, curved, blur).g,
                seen_through(m, ior.b, n, n_geometric, v, curved, blur).b);
#else
    return seen_through(m, m.ior, n, n_geometric, v, curved, blur);
#endif
}
