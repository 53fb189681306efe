// a and b of the split sum for GGX lobes that anisotropy stretches, with alpha = (alpha_t, alpha_b). What they need
// beside the DFG table is in the levels 1 and 2 of its texture (viewer/bake/stretched.py).
#include "light/dfg.glsl"

const float STRETCHED_SIZE = 16.0;

// The means over the hemisphere, of a and b
vec2 stretched_mean(sampler2D table, vec2 alpha) {
    vec2 size = vec2(textureSize(table, 2)), place = (sqrt(min(alpha, 1.0)) * (size - 1.0) + 0.5) / size;
    float guess = min(sqrt(length(alpha) * 0.70710678), 1.0);
    return dfg_mean(table, guess) + textureLod(table, place, 2.0).rg;
}

// Seen from w, in the local frame: x is the tangent, z the normal. Facets have slopes along the azimuth d of w and
// across it. The lobe is the isotropic one of the width along it, and what that lacks: it depends on the other width,
// too, and a little on the correlation rho.
vec2 stretched_albedo(sampler2D table, vec2 alpha, vec3 w) {
    float sine2 = dot(w.xy, w.xy);
    vec2 d = sine2 > 1e-12 ? w.xy * inversesqrt(sine2) : vec2(1.0, 0.0);
    float along = min(length(alpha * d), 1.0), across = min(length(alpha * d.yx), 1.0), NoV = clamp(w.z, 0.0, 1.0);
    float rho = d.x * d.y * (alpha.x - alpha.y) * (alpha.x + alpha.y) / max(along * across, 1e-20);
    float rho2 = min(rho * rho, 1.0), c = min(1.3 * across * across * (1.0 - NoV), 1.0);
    vec3 place = sqrt(vec3(along, across, NoV)) * (STRETCHED_SIZE - 1.0);
    float tile = min(floor(place.z), STRETCHED_SIZE - 2.0);
    vec4 found[2];
    for (int k = 0; k < 2; ++k) {
        float t = tile + float(k); // tiles stand in rows of two
        vec2 corner = STRETCHED_SIZE * vec2(mod(t, 2.0), floor(0.5 * t));
        found[k] = textureLod(table, (corner + place.xy + 0.5) / vec2(textureSize(table, 1)), 1.0);
    }
    vec4 lacking = mix(found[0], found[1], place.z - tile);
    lacking.xy += rho2 * (1.0 - c + c * rho2) * lacking.zw;
    return max(dfg_albedo(table, NoV, sqrt(along)) + lacking.xy, 0.0);
}
