"""Wrong formulas that `pbr-viewer check` is to notice, each with quick checks that do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from mutations import Mutation

from viewer.gpu.context import open_context
from viewer.measure.check.checks import Check
from viewer.measure.check.energy import check_lobe
from viewer.measure.check.fibres import check_fibres
from viewer.measure.check.furnace import FURNACE_BOUND, lit_furnace
from viewer.measure.check.lobe_cases import lobe_cases
from viewer.measure.check.lobe_stability import check_lobe_sweep, lobe_sweeps
from viewer.measure.check.media import check_media
from viewer.measure.check.stability import check_sweep, sweeps
from viewer.measure.check.woven import check_woven
from viewer.raster.renderer import Renderer
from viewer.scene.material import Material

Checks = Callable[[], Iterable[Check]]


@dataclass(frozen=True)
class WrongFormula(Mutation):
    """`checks` are quick ones, some of which fail."""

    checks: Checks


def values(function: str) -> Checks:
    return lambda: [check_sweep(sweep) for sweep in sweeps() if sweep.function == function]


def energy(lobe: str) -> Checks:
    return lambda: (check for case in lobe_cases() if case.name == lobe for check in check_lobe(case))


def lobe_values(lobe: str) -> Checks:
    return lambda: [check_lobe_sweep(sweep) for sweep in lobe_sweeps() if sweep.name == lobe]


def furnace_of_lights() -> Iterator[Check]:
    with open_context() as context:
        light = lit_furnace(Renderer(context, use_cache=False), Material(perceptual_roughness=0.75), 0.5)
        yield Check("furnace of lights", "roughness 0.75", abs(light - 1), FURNACE_BOUND)


_D = "float k = alpha / (s2 + alpha * alpha * NoH * NoH);\n    return k * k * INV_PI;"
_V = "return 0.5 / (NoL * t_v + NoV * t_l);"
_V_LOCAL = "return 0.5 / (smith_t(wo, alpha) * wi.z + smith_t(wi, alpha) * wo.z);"
WRONG_FORMULAS = [
    WrongFormula("pi missing in D", "bsdf/ggx.glsl", _D, _D.replace(" * INV_PI", ""), values("d_ggx")),
    WrongFormula("pi missing in the mean of D over a pixel", "bsdf/pixel_lobe.glsl", "return d * INV_PI / (",
                 "return d / (", furnace_of_lights),
    WrongFormula("pi missing in the lobes' D", "bsdf/ggx_local.glsl", "return INV_PI / (", "return 1.0 / (",
                 energy("ggx")),
    WrongFormula("alpha for alpha squared", "bsdf/ggx.glsl", _D, _D.replace("alpha * alpha * NoH", "alpha * NoH"),
             values("d_ggx")),
    WrongFormula("separable for correlated G", "bsdf/ggx.glsl", _V, "return 1.0 / ((NoV + t_v) * (NoL + t_l));",
             furnace_of_lights),
    WrongFormula("separable for correlated G in the lobes", "bsdf/ggx_local.glsl", _V_LOCAL,
             "return 1.0 / ((wo.z + smith_t(wo, alpha)) * (wi.z + smith_t(wi, alpha)));", energy("metal")),
    WrongFormula("the width across the view for that along it", "light/stretched_dfg.glsl",
                 "min(length(alpha * d), 1.0)", "min(length(alpha * d.yx), 1.0)",
                 energy("standard anisotropic, stretched")),
    WrongFormula("(1 - E) forgotten in the blend", "bsdf/layer/interface.glsl",
             "face.scaled_transmittance * interface_transmittance(face, dfg_light)", "1.0", energy("standard")),
    WrongFormula("V clamped at 1", "bsdf/ggx.glsl", _V, "return min(0.5 / (NoL * t_v + NoV * t_l), 1.0);",
             values("v_smith_ggx")),
    WrongFormula("sample and pdf with different probabilities", "bsdf/kulla_conty.glsl",
             "if (u.z < p_diffuse) {", "if (u.z < 0.5 * p_diffuse) {", energy("metal")),
    WrongFormula("textbook D in float32", "bsdf/ggx.glsl", _D,
             "float k = 1.0 + NoH * NoH * (alpha * alpha - 1.0);\n    return alpha * alpha / (PI * k * k);",
             values("d_ggx")),
    WrongFormula("sRGB by pow 2.2", "display/srgb.glsl",
             "return mix(high, low, lessThanEqual(c, vec3(0.0031308)));", "return pow(c, vec3(1.0 / 2.2));",
                 values("srgb_from_linear")),
    WrongFormula("transmission with the reflection's G2", "bsdf/lobe/dielectric.glsl",
             "float g2 = g2_transmission_ggx(lambda_ggx_local(wo, a), lambda_ggx_local(wi, a));",
             "float g2 = 1.0 / (1.0 + lambda_ggx_local(wo, a) + lambda_ggx_local(wi, a));",
             lobe_values("dielectric")),
    WrongFormula("a wall of one face", "bsdf/lobe/thin_dielectric.glsl", "return 2.0 * R / (1.0 + R);", "return R;",
             lobe_values("thin_dielectric")),
    WrongFormula("the peak of a phase function by subtraction", "media/phase.glsl",
                 "float t2 = (1.0 - g) * (1.0 - g) + 2.0 * g * x;", "float t2 = 1.0 + g * g - 2.0 * g * (1.0 - x);",
                 values("phase_eval")),
    WrongFormula("light scattered forwards for backwards", "media/phase.glsl",
                 "return direction_about(g < 0.0 ? -direction : direction, x, sine, u.y);",
                 "return direction_about(direction, x, sine, u.y);", check_media),
    WrongFormula("1 - exp(-x) in float32", "media/one_minus_exp.glsl", "if (x > 0.5) return 1.0 - exp(-x);",
                 "if (x > 0.0) return 1.0 - exp(-x);", values("one_minus_exp(float)")),
    WrongFormula("one channel's density for all", "media/distance.glsl", "return f / max(dot(chances, f), 1e-37);",
                 "return f / max(f.r, 1e-37);", check_media),
    WrongFormula("the rest of a fibre's light as one more reflection", "bsdf/fibre/attenuation.glsl",
                 "t * F * F * T * T * T * share", "t * t * F * F * T * T * T", check_fibres),
    WrongFormula("samples of a fibre about the other side of the ray", "bsdf/fibre/fibre.glsl",
                 "complex_product(lobes.turn[p], azimuthal_sample(lobes.scale, u.w))",
                 "complex_product(conjugate(lobes.turn[p]), azimuthal_sample(lobes.scale, u.w))", check_fibres),
    WrongFormula("what woven yarns mirror kept in their diffuse light", "bsdf/weave/woven_view.glsl",
                 "v.rest = woven_rest(m, met, once);", "v.rest = vec3(met);", check_woven),
    WrongFormula("light of woven yarns from the bottom of a layer kept in its reflection", "bsdf/weave/depth.glsl",
                 "    d.back = color * x * d.through;", "    d.back = vec3(0.0);", check_woven),
]
