// The functions that every lobe (BSDF) defines.
//
// Local frame: z = shading normal, x = tangent. wo points to the viewer, wi to the light; both point away from the
// surface, and wo.z > 0.
//   vec3       <lobe>_eval(M m, vec3 wo, vec3 wi)      f, without the cosine
//   BsdfSample <lobe>_sample(M m, vec3 wo, vec3 u)     u uniform in [0, 1)^3; u.z chooses between parts of a lobe
//   float      <lobe>_pdf(M m, vec3 wo, vec3 wi)       density of _sample with respect to solid angle
//   vec3       <lobe>_albedo(M m, float NoV)           integral of f |cos| over wi (directional albedo), for layering
// M is a struct of the lobe's parameters. Roughness is alpha unless the member is called perceptual_roughness. A
// microfacet lobe takes the DFG table as the last argument, sampler2D dfg. _sample and _pdf get the probabilities of
// the lobe's parts from one common function.
//
// bsdf/surface.glsl composes the layers of a surface (bsdf/layer/interface.glsl). The lobes of bsdf/lobe/ are for
// glass. The lobes of bsdf/compare/ are used by no renderer; they are for comparison and are checked too.
#include "bsdf/constants.glsl"

const uint REFLECTION = 1u;
const uint TRANSMISSION = 2u;
const uint DELTA = 4u; // a single direction: eval and pdf do not include it, and the sample's pdf is its probability

// flags = 0 means that there is no light from this direction (it is below the surface); weight and pdf are 0.
struct BsdfSample {
    vec3 wi;
    vec3 weight; // f |cos| / pdf
    float pdf;
    uint flags;
    float eta;   // if the surface was crossed: index of refraction on wi's side over that on wo's side; else 1
};

const BsdfSample NO_SAMPLE = BsdfSample(vec3(0.0, 0.0, 1.0), vec3(0.0), 0.0, 0u, 1.0);

// A lobe with a smaller alpha is a mirror, with the flag DELTA. At this alpha its width is a twentieth of a degree, and
// float32 directions resolve its profile to 1 in 1e4.
const float DELTA_ALPHA = 1e-3;

bool is_delta(vec2 alpha) {
    return max(alpha.x, alpha.y) < DELTA_ALPHA;
}

// alpha of an anisotropic lobe that is rough in at least one direction, kept away from 0 in the other
vec2 finite_alpha(vec2 alpha) {
    return max(alpha, DELTA_ALPHA);
}
