// What every lobe looks like.
//
// Local frame: z = shading normal, x = tangent. wo to the viewer, wi to the light, both leave the surface; wo.z > 0.
//   vec3       <lobe>_eval(M m, vec3 wo, vec3 wi)      f, without the cosine
//   BsdfSample <lobe>_sample(M m, vec3 wo, vec3 u)     u uniform in [0, 1)^3, u.z chooses where a lobe has parts
//   float      <lobe>_pdf(M m, vec3 wo, vec3 wi)       of _sample, by solid angle
//   vec3       <lobe>_albedo(M m, float NoV)           integral of f |cos| over wi, for layering
// M holds the lobe's own parameters, in alpha and never in perceptual roughness unless it says so. A lobe of facets takes
// the table of their albedo last, sampler2D dfg. One function gives the probability of a lobe's parts, to sample and pdf
// alike.
//
// How lobes lie over one another is said in bsdf/surface.glsl, by layers (bsdf/layer/interface.glsl). The lobes of
// bsdf/lobe/ are those of glass; the lobes of bsdf/compare/ are in no renderer: they illustrate, and are checked.
#include "bsdf/constants.glsl"

const uint REFLECTION = 1u;
const uint TRANSMISSION = 2u;
const uint DELTA = 4u; // one direction only: eval and pdf know nothing of it, the sample's pdf is its probability

// flags = 0: no light goes there (the sample fell below the surface), weight and pdf are 0.
struct BsdfSample {
    vec3 wi;
    vec3 weight; // f |cos| / pdf
    float pdf;
    uint flags;
    float eta;   // index of refraction beyond over before the surface when it was crossed, else 1
};

const BsdfSample NO_SAMPLE = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, 0u, 1.0);

// Below it a lobe is a mirror with the flag DELTA. Its width then is a twentieth of a degree, and float32 directions
// resolve its profile to 1 in 1e4.
const float DELTA_ALPHA = 1e-3;

bool is_delta(vec2 alpha) {
    return max(alpha.x, alpha.y) < DELTA_ALPHA;
}

// Of an anisotropic lobe that is rough one way at least
vec2 finite_alpha(vec2 alpha) {
    return max(alpha, DELTA_ALPHA);
}
