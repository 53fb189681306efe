"""Proves the path tracer's golden images as break_shaders.py does the raster's.

    python tests/golden/break_path_shaders.py [NAME...]

Exits with status 1 where a mutation goes unnoticed. Takes minutes: no part of the test run.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from mutations import Mutation, try_all
from path_cases import CASES, SIZE
from path_golden import PathGolden

from viewer.gpu.context import Context, open_context
from viewer.trace.tracer import Tracer

MUTATIONS = [
    Mutation("the cosine's density without 1/pi", "sample/hemisphere.glsl", "return max(w.z, 0.0) * INV_PI;",
             "return max(w.z, 0.0);"),
    Mutation("density of the lobes mixed by halves", "bsdf/surface.glsl",
             "mix(diffuse, facets, facet_probability(s, v))", "mix(diffuse, facets, 0.5)"),
    Mutation("a light's sample counts in full", "trace/mis.glsl", "? mis_weight(light_pdf, bsdf_pdf) :", "? 1.0 :"),
    Mutation("a light's sample weighed by the wrong density", "trace/mis.glsl", "? mis_weight(light_pdf, bsdf_pdf) :",
             "? mis_weight(bsdf_pdf, light_pdf) :"),
    Mutation("emission that is hit counts in full", "trace/bounce.glsl",
             "weight = bsdf_weight(p.pdf, light_pdf);",
             "weight = 1.0;"),
    Mutation("density of emitters 5 % too large", "trace/lights.glsl", "s.pdf *= density;", "s.pdf *= 1.05 * density;"),
    Mutation("density of the environment 5 % too large", "trace/environment.glsl",
             "pdf = u_environment_share * uintBitsToFloat(is_own",
             "pdf = 1.05 * u_environment_share * uintBitsToFloat(is_own"),
    Mutation("aliases with their neighbours' density in the environment", "trace/environment.glsl",
             "(is_own ? entry.z : entry.w)", "(entry.z)"),
    Mutation("a light candidate counts for both", "trace/light_candidates.glsl", "sum / (float(count) * own)",
             "sum / own"),
    Mutation("a light candidate alone counts in full", "trace/light_candidates.glsl",
             "    if (count > 1) chosen.f_cos *=", "    if (count > 1 && own < sum) chosen.f_cos *="),
    Mutation("light candidates chosen by halves", "trace/light_candidates.glsl", "u.w * sum >= brings", "u.w >= 0.5"),
    Mutation("light candidates weighed by the light's density alone", "trace/light_candidates.glsl",
             "SurfaceLight(light, f.rgb, f.w, side)", "SurfaceLight(light, f.rgb, light.pdf, side)"),
    Mutation("a sample of the BSDF weighs as beside one light candidate", "trace/shade.glsl",
             "pdf /= float(candidates);", ""),
    Mutation("emitter's density without its cosine", "trace/lights.glsl", "float facing = area * cos_light;",
             "float facing = area;"),
    Mutation("roulette without compensation", "trace/bounce.glsl", "p.throughput /= survival;", ""),
    Mutation("roulette's bound on the division alone", "trace/bounce.glsl", "if (u >= survival) return false;",
             "if (u >= survival / most) return false;"),
    Mutation("roulette divides by half of the probability", "trace/bounce.glsl",
             "if (u >= survival) return false;", "if (u >= survival) return false;\n        survival *= ENDURES;"),
    Mutation("refraction without 1/eta^2", "bsdf/lobe/dielectric.glsl", "weight /= m.eta * m.eta;", ""),
    Mutation("absorption of the wrong sign", "media/medium.glsl", "exp(-scene_float4", "exp(scene_float4"),
    Mutation("absorption goes on outside", "trace/surface_sides.glsl", "return i.is_front ? i.medium : 0;",
             "return i.medium;"),
    Mutation("glass tints twice", "bsdf/glass.glsl", "g.tint = sqrt(max(m.base_color.rgb, vec3(0.0)));",
             "g.tint = m.base_color.rgb;"),
    Mutation("rough glass loses what meets a second facet", "bsdf/glass.glsl",
             "if (is_delta(g.alpha)) return 1.0;", "return 1.0;"),
    Mutation("thin glass reflects at one face", "bsdf/lobe/thin_dielectric.glsl", "return 2.0 * R / (1.0 + R);",
             "return R;"),
    Mutation("what alpha leaves open is solid to paths", "trace/bounce.glsl", "if (u >= m.coverage) return true;", ""),
    Mutation("what alpha leaves open is solid to shadow rays", "trace/material.glsl",
             "return coverage_of(alpha, tri.material, tri.flags);", "return 1.0;"),
    Mutation("roughness from the wrong channel", "material/records.glsl", "m.perceptual_roughness *= texel.g;",
             "m.perceptual_roughness *= texel.b;"),
    Mutation("stretched across the tangent in paths", "bsdf/facets.glsl", "return vec2(s.alpha_t, s.alpha);",
             "return vec2(s.alpha, s.alpha_t);"),
    Mutation("direction of anisotropy ignored", "trace/surface_sides.glsl", "d.x * i.tangent + d.y * i.bitangent",
             "i.tangent"),
    Mutation("f0 of every texel the same in paths", "bsdf/specular_glossiness.glsl", "m.specular_color *= texel.rgb;",
             ""),
    Mutation("density of rough diffuse paths without its uniform part", "bsdf/eon_sample.glsl",
             "return mix(shaped, 0.5 * INV_PI, m.p_uniform);", "return shaped;"),
    Mutation("normal map's scale ignored", "trace/interaction.glsl", "texel.xy *= scale;", ""),
    Mutation("film's thickness from the channel of its weight in paths", "bsdf/iridescence_thickness.glsl",
             "iridescence_thickness_maximum, texel.g", "iridescence_thickness_maximum, texel.r"),
    Mutation("film's map of thickness ignored in paths", "bsdf/iridescence_thickness.glsl",
             "iridescence_thickness_maximum, texel.g", "iridescence_thickness_maximum, 1.0"),
    Mutation("film on one face of thin glass in paths", "bsdf/lobe/thin_dielectric.glsl", "return 2.0 * R / (1.0 + R);",
             "float B = f_dielectric(mu, m.eta); return (R + B - 2.0 * R * B) / max(1.0 - R * B, 1e-6);"),
    Mutation("sheen's density mixed by halves", "bsdf/surface.glsl",
             "pdf = mix(pdf, sheen_pdf(v.sheen, a), sheen_probability(s, v));",
             "pdf = mix(pdf, sheen_pdf(v.sheen, a), 0.5);"),
    Mutation("sheen takes nothing from the cloth in paths", "bsdf/layer/sheen.glsl",
             "return sheen + s.throughput * below;", "return sheen + below;"),
    Mutation("coat takes nothing from what lies below in paths", "bsdf/layer/coat.glsl",
             "coat + c.throughput * below", "coat + below"),
    Mutation("coat's mirror counts in full", "bsdf/layer/coat.glsl", "/ max(chosen, 1e-6)", ""),
    Mutation("coat's density mixed by halves", "bsdf/layer/coat.glsl", "mix(below.a, pdf, c.probability)",
             "mix(below.a, pdf, 0.5)"),
    Mutation("coat takes nothing from emission in paths", "trace/emission.glsl", "u_dfg).throughput * emission",
             "u_dfg).throughput * 0.0 + emission"),
    Mutation("coat follows the bumps below in paths", "trace/interaction.glsl",
             "i.n_coat = bend_normal(n_coat, i.n_geometric, wo);", "i.n_coat = i.n;"),
    Mutation("dispersion the other way round", "bsdf/dispersion.glsl", "dispersion * 0.05 * cauchy",
             "dispersion * -0.05 * cauchy"),
    Mutation("density below without its probability", "bsdf/diffuse_transmission.glsl",
             "p_diffuse * below_probability(s, v) *", "p_diffuse *"),
    Mutation("density above as if nothing went below", "bsdf/surface.glsl",
             "diffuse *= 1.0 - below_probability(s, v);", ""),
    Mutation("share of diffuse transmission from the wrong channel", "material/records.glsl",
             "m.diffuse_transmission *= texel.a;", "m.diffuse_transmission *= texel.r;"),
    Mutation("light in media by half too bright", "trace/medium.frag", "light, vec3(phase), phase);",
             "light, vec3(1.5 * phase), phase);"),
    Mutation("collisions in volumes without their albedo", "trace/medium.frag",
             "        p.throughput *= albedo_left(m.albedo, p);\n", ""),
    Mutation("volumes cast half a shadow", "media/tracking.glsl",
             "transmittance *= max(1.0 - collision_density", "transmittance *= max(1.0 - 0.5 * collision_density"),
    Mutation("thin walls scatter nothing", "bsdf/thin_scatter.glsl", "m.transmission * m.scatter_strength, kept",
             "0.0, kept"),
    Mutation("media of bodies isotropic in paths", "media/any_phase.glsl", "return phase_sample(phase, direction, u);",
             "return phase_sample(0.0, direction, u);"),
    Mutation("highlights of hair lean the other way in paths", "bsdf/fibre/fibre.glsl",
             "vec2 t1 = vec2(cos(f.tilt), sin(f.tilt));", "vec2 t1 = vec2(cos(f.tilt), -sin(f.tilt));"),
    Mutation("light on hair at the middle of each fibre", "trace/fibre.frag",
             "float h = fibre_offset(vec3(0.0, 0.0, 1.0), wo);", "float h = 0.0;"),
    Mutation("density of samples of hair twice what it is", "bsdf/fibre/fibre.glsl",
             "return dot(fibre_chances(lobes), fibre_densities(lobes, wo, wi));",
             "return 2.0 * dot(fibre_chances(lobes), fibre_densities(lobes, wo, wi));"),
    Mutation("density of samples of hair as if all lobes were chosen alike", "bsdf/fibre/fibre.glsl",
             "return dot(fibre_chances(lobes), fibre_densities(lobes, wo, wi));",
             "return dot(vec4(0.25), fibre_densities(lobes, wo, wi));"),
    Mutation("yarns of a weave do not hide light from each other in paths", "bsdf/weave/woven_view.glsl",
             "return lean > slope * m.horizon ? 0.0 : clamp(1.0 + lean, 0.0, 1.0);", "return 1.0;"),
    Mutation("yarns of a weave are straight in paths", "bsdf/weave/weave.glsl", "float bend = -along * shape.z;",
             "float bend = 0.0;"),
    Mutation("warp and weft exchanged in paths", "bsdf/weave/weave.glsl", "& 1) == 1) == is_front;",
             "& 1) == 1) != is_front;"),
    Mutation("density of what woven fibres mirror twice what it is", "bsdf/weave/woven.glsl",
             "(flakes_fresnel(azimuth) * weight), v.chance.y);",
             "(flakes_fresnel(azimuth) * weight), 2.0 * v.chance.y);"),
]


def noticed_by(context: Context) -> list[str]:
    """The golden images that the path tracer's pictures do not match."""
    tracer = Tracer(context, use_cache=False)
    found = []
    for case in CASES:
        picture = tracer.render(*case.make(), case.with_seed(1), SIZE)
        if picture.stats["bad_samples"] or PathGolden.load(case.name).problem(picture.linear[..., :3]) is not None:
            found.append(case.name)
    tracer.release()
    return found


def main(names: list[str]) -> int:
    with open_context() as context:
        unbroken = noticed_by(context)
        if unbroken:
            print(f"without any mutation these differ already: {', '.join(unbroken)}", file=sys.stderr)
            return 1
        return try_all(MUTATIONS, names, lambda _: noticed_by(context))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
