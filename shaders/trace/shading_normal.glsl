// Shading normals that keep reflected directions above the surface, and tangents beside them.
#include "sample/orthonormal_basis.glsl"

// Bends the normal n so that the mirror direction r of wo is at least `lift` above the surface: if r is lower, it is
// raised to that height, and n' is the normal that mirrors wo to the raised r'. The function is continuous, even in n,
// and the identity where n is n_geometric.
//   r = 2 (n.o) n - o,   r' = r where r.g >= lift, else sqrt(1 - lift^2) unit(r - (r.g) g) + lift g
//   n' = unit(o + r')
// so n'.o >= (g.o + lift) / 2 > 0. Keller et al. 2017, "The Iray Light Transport Simulation and Rendering System",
// appendix A.3, raise r to the horizon; `lift` keeps r' above it. n_geometric (g) and wo (o) are on the same side.
vec3 bend_normal(vec3 n, vec3 n_geometric, vec3 wo) {
    float cos_wo = dot(n_geometric, wo);
    if (cos_wo < 1e-6) return n_geometric;
    float lift = min(0.9 * cos_wo, 0.01);
    float cos_n = dot(n, wo);
    vec3 r = 2.0 * cos_n * n - wo;
    float height = dot(r, n_geometric);
    if (height >= lift) return cos_n < 0.0 ? -n : n;
    vec3 flat_r = r - height * n_geometric;
    float flat_length = length(flat_r);
    if (flat_length < 1e-6) return n_geometric;
    vec3 raised = flat_r * (sqrt(1.0 - lift * lift) / flat_length) + lift * n_geometric;
    vec3 sum = wo + raised;
    float sum_length = length(sum);
    vec3 bent = sum / sum_length;
    // Where wo and r' nearly cancel, n' has few correct digits. This corrects it along wo by n'.o = |o + r'| / 2.
    return normalize(bent + (0.5 * sum_length - dot(bent, wo)) * wo);
}
