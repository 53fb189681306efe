// What rims of thin-walled glass reflect. At grazing angles the mirrored ray goes on nearly straight, so that what is
// behind on the screen (raster/backdrop.glsl) is what it meets, and hides the environment. Beside a flat wall, seen
// along itself, the picture shows what lies below its plane, which is not what it reflects.
#include "raster/backdrop.glsl"
#include "raster/curvature.glsl"

uniform float u_alpha_tells; // 1 if alpha is 0 where the picture behind shows the environment, else 0

const float WAY = 0.2; // to what is behind, in radii of the scene: a guess

// Radiance, and the share of the lobe that it takes the place of: 1 where light goes on straight, 0 where it turns by
// 41 degrees (cosine 3/4) and more, less on what is curved less than a ball with the radius WAY, and on rough walls:
// one ray cannot stand for their lobe.
vec4 picture_behind(vec3 n, vec3 n_geometric, vec3 v, float perceptual_roughness) {
    vec3 d = reflect(-v, n);
    float straight = max(-3.0 - 4.0 * dot(d, v), 0.0);
    float curved = min(WAY * abs(curvature(n_geometric, v_position)), 1.0);
    float smoothness = 1.0 - smoothstep(0.2, 0.5, perceptual_roughness);
    float share = u_alpha_tells * straight * curved * smoothness;
    if (share == 0.0) return vec4(0.0);
    return share * backdrop_at(v_position + WAY * d, perceptual_roughness);
}
