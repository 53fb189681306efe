// The clear coat: a colourless dielectric of index 1.5 over all that is below it, emission included
// (KHR_materials_clearcoat). It has its own roughness and its own normal. Its weight w scales its reflectance: f0 =
// 0.04 w, f90 = w.
//   f cos = f_coat (n_coat.i) + (1 - E(o)) * f cos of what lies below
// E is the directional albedo of the coat. It depends on the viewer's direction alone, as in the extension. So a white
// stack reflects all light whatever lies below, even where the two normals differ; in return it is not reciprocal.
#include "bsdf/bsdf.glsl"
#include "bsdf/half_vector.glsl"
#include "bsdf/layer/dielectric.glsl"
#include "light/dfg.glsl"
#include "sample/orthonormal_basis.glsl"
#include "sample/share_of.glsl"

const float COAT_IOR = 1.5, COAT_F0 = 0.04;

// The coat as seen from one direction
struct Coat {
    vec3 n;               // in the space of the directions v and l, or wo and wi
    float NoV, alpha, perceptual_roughness;
    vec2 dfg;             // (a, b) of the split sum for NoV
    Interface face;
    float throughput;     // 1 - E
    float probability;    // of sampling the coat and not what lies below
};

Coat make_coat(float weight, float alpha, vec3 n, float NoV, sampler2D dfg) {
    Coat c;
    c.n = n;
    c.NoV = NoV;
    c.alpha = alpha;
    c.perceptual_roughness = is_delta(vec2(alpha)) ? 0.0 : sqrt(alpha);
    c.dfg = dfg_albedo(dfg, NoV, c.perceptual_roughness);
    c.face = make_interface(vec3(COAT_F0 * weight), vec3(weight), c.dfg, dfg_mean(dfg, c.perceptual_roughness));
    c.throughput = interface_transmittance(c.face, c.dfg);
    c.probability = 0.0;
    return c;
}

vec3 coat_response(Coat c, float VoH, float dv, vec2 dfg_light) {
    return interface_response(c.face, dielectric_fresnel(c.face, VoH, COAT_IOR), dv, dfg_light);
}

// Radiance reflected from an environment; the arguments are those of interface_environment.
vec3 coat_environment(Coat c, mat2x3 specular, vec3 mean_light) {
    vec3 single = c.face.f0 * (c.dfg.x * specular[0]) + c.face.f90 * (c.dfg.y * specular[1]);
    vec3 multiple = c.face.F_ms * energy_loss(c.dfg) * mean_light;
    return single * float(SHOW_SPECULAR) + multiple * float(SHOW_MULTISCATTER);
}

vec3 coat_over(Coat c, vec3 coat, vec3 below) {
    return coat + c.throughput * below;
}

// ---- The coat in a mixture of lobes, each sampled in proportion to its albedo

vec3 coat_albedo(Coat c) {
    return c.face.E_ss * float(SHOW_SPECULAR) + c.face.F_ms * (energy_loss(c.dfg) * float(SHOW_MULTISCATTER));
}

float coat_probability(Coat c, float albedo_below) {
    float albedo = coat_albedo(c).x;
    return share_of(albedo, c.throughput * albedo_below);
}

// rgb: f |cos|, w: the pdf, of the coat and of what lies below, whose own are `below`
vec4 coat_eval_pdf(Coat c, vec3 wo, vec3 wi, vec4 below, sampler2D dfg) {
    float NoL = dot(c.n, wi);
    vec3 f = vec3(0.0);
    float pdf = 0.0;
    if (NoL > 0.0 && c.probability > 0.0) {
        vec3 h = normalize(wo + wi), nxh = cross(c.n, h);
        float NoH = dot(c.n, h), VoH = clamp(dot(wo, h), 0.0, 1.0), dv = 0.0;
        if (!is_delta(vec2(c.alpha))) {
            dv = d_microfacet(NoH, dot(nxh, nxh), c.alpha) * v_microfacet(c.NoV, NoL, NoH, VoH, c.alpha);
            mat3 frame = orthonormal_basis(c.n);
            pdf = pdf_half_reflection(wo * frame, h * frame, c.alpha);
        }
        f = coat_response(c, VoH, dv, dfg_albedo(dfg, NoL, c.perceptual_roughness)) * NoL;
    }
    return vec4(coat_over(c, f, below.rgb), mix(below.a, pdf, c.probability));
}

// Whether the coat is sampled. u.z is made uniform again for choices in what lies below.
bool coat_is_chosen(Coat c, inout vec3 u) {
    bool is_coat = u.z < c.probability;
    u.z = is_coat ? u.z / c.probability : (u.z - c.probability) / max(1.0 - c.probability, 1e-6);
    u.z = min(u.z, 1.0 - 1.0 / 16777216.0);
    return is_coat;
}

// A direction that the coat reflects. Unless it is a mirror's, weight and pdf are still those of nothing.
BsdfSample coat_sample(Coat c, vec3 wo, vec2 u) {
    if (is_delta(vec2(c.alpha))) {
        vec3 F = dielectric_fresnel(c.face, c.NoV, COAT_IOR) * float(SHOW_SPECULAR);
        return BsdfSample(2.0 * c.NoV * c.n - wo, F, 1.0, REFLECTION | DELTA, 1.0);
    }
    mat3 frame = orthonormal_basis(c.n);
    vec3 h = frame * sample_half(wo * frame, c.alpha, u);
    vec3 wi = normalize(2.0 * dot(wo, h) * h - wo);
    if (dot(c.n, wi) <= 0.0) return NO_SAMPLE;
    return BsdfSample(wi, vec3(0.0), 0.0, REFLECTION, 1.0);
}

// The sample of a mirror, the coat or one below it, as one of the mixture
BsdfSample coat_delta(Coat c, bool is_coat, BsdfSample b) {
    float chosen = is_coat ? c.probability : 1.0 - c.probability;
    b.weight *= (is_coat ? 1.0 : c.throughput) / max(chosen, 1e-6);
    b.pdf *= chosen;
    return b;
}
