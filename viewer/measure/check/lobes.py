"""Every lobe of shaders/bsdf/lobe: its functions, the ranges of its parameters, and the checks it is known to fail."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from ...gpu.call import call_glsl
from ...gpu.context import Context
from ...settings import MASKINGS, NDFS

TRANSMISSION, DELTA = 2, 4
"""Bits of a sample's flags, as in bsdf.glsl."""

ALPHAS = (0.0, 1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0)
COSINES = (1.0, 0.5, 0.1, 1e-3, 1e-6)
ETAS = (1.0, 1.0001, 1.05, 1.5, 2.4, 100.0, 1 / 1.5)
F0S = (0.0, 0.04, 1.0)


@dataclass(frozen=True)
class ParameterRange:
    """The values that a parameter may have: from `low` to `high`, and `extremes`, which are always tried.

    Values are drawn evenly, or evenly in the logarithm. `size` is the number of components, 1 for a float; each is
    drawn by itself.
    """

    low: float
    high: float
    extremes: tuple[float, ...]
    size: int = 1
    logarithmic: bool = False

    def draw(self, rng: np.random.Generator, count: int) -> np.ndarray:
        """(count,) or (count, size) float64, a third of them extremes."""
        shape = (count,) if self.size == 1 else (count, self.size)
        if self.logarithmic:
            values = np.exp(rng.uniform(np.log(self.low), np.log(self.high), shape))
        else:
            values = rng.uniform(self.low, self.high, shape)
        extreme = rng.random(count) < 1 / 3
        return np.where(extreme.reshape(count, *(1,) * (len(shape) - 1)), rng.choice(self.extremes, shape), values)


COLOR = ParameterRange(0.0, 1.0, (0.0, 1.0), size=3)
F0 = ParameterRange(0.0, 1.0, F0S, size=3)
UNIT = ParameterRange(0.0, 1.0, (0.0, 1e-4, 0.5, 1.0))
ALPHA = ParameterRange(1e-3, 1.0, ALPHAS, logarithmic=True)
ALPHA_2 = ParameterRange(1e-3, 1.0, ALPHAS, size=2, logarithmic=True)
FILM_IOR = ParameterRange(1.0, 2.5, (1.0, 1.3, 3.0))
THICKNESS = ParameterRange(10.0, 3000.0, (0.0, 1e-3, 400.0, 1e6), logarithmic=True)
SHININESS = ParameterRange(1.0, 1e4, (0.0, 1.0, 1e3), logarithmic=True)


@dataclass(frozen=True)
class Lobe:
    """A lobe: the functions `prefix`_eval, _sample, _pdf and _albedo of `file`, on the struct of `parameters`.

    `white` are the parameters for the white furnace. `failures` are checks that the model is known to fail, each with
    the reason: energy (reflects more than it receives), furnace (is white and reflects less), reciprocity. `transmits`
    is how light continues beyond the surface: refracted by the struct's eta, or "mirrored": in the direction of
    reflection, mirrored at the surface's plane. `unused` are members of the struct that the defines leave without
    effect.
    """

    name: str
    file: str
    prefix: str
    parameters: Mapping[str, ParameterRange]
    white: Mapping[str, float]
    failures: Mapping[str, str] = field(default_factory=dict)
    table: tuple[str, str] | None = ("ggx", "smith")
    defines: Mapping[str, int] = field(default_factory=dict)
    transmits: Literal["", "refracted", "mirrored"] = ""
    unused: Mapping[str, float] = field(default_factory=dict)

    def eval(self, m: Mapping[str, Any], wo: Any, wi: Any, context: Context | None = None) -> np.ndarray:
        """f, without the cosine, (..., 3)."""
        return self._call("eval", m, context, wo=wo, wi=wi)

    def sample(self, m: Mapping[str, Any], wo: Any, u: Any, context: Context | None = None) -> dict[str, np.ndarray]:
        """Of u (..., 3) in [0, 1): wi, weight = f |cos| / pdf, pdf, flags, eta."""
        return self._call("sample", m, context, wo=wo, u=u)

    def pdf(self, m: Mapping[str, Any], wo: Any, wi: Any, context: Context | None = None) -> np.ndarray:
        """Of `sample`, by solid angle, without its mirror directions."""
        return self._call("pdf", m, context, wo=wo, wi=wi)

    def albedo(self, m: Mapping[str, Any], NoV: Any, context: Context | None = None) -> np.ndarray:
        """The integral of f |cos| over wi as the lobe itself has it, for layering, (..., 3)."""
        return self._call("albedo", m, context, NoV=NoV)

    def draw(self, rng: np.random.Generator, count: int) -> dict[str, np.ndarray]:
        """Parameters for `count` lobes, their extremes among them."""
        return {name: range_.draw(rng, count) for name, range_ in self.parameters.items()}

    def struct(self, **parameters: Any) -> dict[str, Any]:
        """The white lobe with `parameters` in place of its own, those it has."""
        return {**self.white, **{name: value for name, value in parameters.items() if name in self.parameters}}

    def _call(self, function: str, m: Mapping[str, Any], context: Context | None, **arrays: Any) -> Any:
        if self.table:
            from ...bake.dfg import dfg_albedos
            from ...bake.stretched import stretched_levels

            levels = stretched_levels(self.table[1]) if self.defines.get("ANISOTROPIC") else ()
            arrays["dfg"] = dfg_albedos(*self.table), *levels
        return call_glsl(f"bsdf/{self.file}.glsl", f"{self.prefix}_{function}", m={**self.unused, **m}, **arrays,
                         defines=self.defines, context=context)


_LOST = "light that scatters more than once is lost"
_GGX = {"f0": F0, "f90": COLOR, "alpha": ALPHA_2}
_WHITE_GGX = {"f0": 1.0, "f90": 1.0, "alpha": 0.5}
_SHOW_ALL = {"MULTISCATTER": 1, "SHOW_DIFFUSE": 1, "SHOW_SPECULAR": 1, "SHOW_MULTISCATTER": 1}


_FILM = {"f0": ParameterRange(0.02, 1.0, (0.04, 1.0), 3), "f90": ParameterRange(1.0, 1.0, (1.0,), 3), "film": UNIT,
         "film_ior": FILM_IOR, "film_thickness": THICKNESS}
_WHITE_FILM = {"f0": 0.04, "f90": 1.0, "film": 1.0, "film_ior": 1.4, "film_thickness": 350.0}


def _phong(name: str, file: str, failures: Mapping[str, str]) -> Lobe:
    return Lobe(name, f"compare/{file}", name, {"specular": COLOR, "shininess": SHININESS},
                {"specular": 1.0, "shininess": 10.0}, failures, table=None)


def _microfacet(ndf: str, masking: str, index: tuple[int, int]) -> Lobe:
    failures = {"furnace": _LOST}
    if masking == "none":
        failures["energy"] = "nothing is masked: without bound at grazing"
    elif ndf == "blinn-phong" and masking != "v-cavity":
        failures["energy"] = "Beckmann's masking is not its own: too little at grazing when rough"
    return Lobe(f"{ndf} {masking}", "compare/microfacet", "microfacet", {"f0": F0, "f90": COLOR, "alpha": ALPHA},
                {"f0": 1.0, "f90": 1.0, "alpha": 0.5}, failures, (ndf, masking),
                {"NDF": index[0], "MASKING": index[1]})


def _glass(name: str, masking: str, film: bool = False) -> Lobe:
    index, is_thin = MASKINGS.index(masking), name == "thin_dielectric"
    low, extremes = (1.0, tuple(eta for eta in ETAS if eta >= 1)) if is_thin else (0.4, ETAS)
    eta = ParameterRange(low, 3.0, extremes)
    title = f"{name} with a film" if film else name if index == 0 else f"{name} {masking}"
    return Lobe(title, f"lobe/{name}", name, {"eta": eta, "alpha": ALPHA_2, **(_FILM if film else {})},
                {"eta": 1.5, "alpha": 0.5, **(_WHITE_FILM if film else {})}, {"furnace": _LOST}, ("ggx", masking),
                {"MASKING": index, "IRIDESCENT": int(film)}, "mirrored" if is_thin else "refracted",
                {} if film else dict.fromkeys(_FILM, 0.0))


_SURFACE = {"base_color": COLOR, "metallic": UNIT, "f0": F0, "f90": UNIT,
            "ior": ParameterRange(1.0, 3.0, (0.0, 1.0, 1.5)), "alpha": ALPHA, "alpha_t": ALPHA}
_WHITE_SURFACE = {"base_color": 1.0, "metallic": 1.0, "f0": 0.04, "f90": 1.0, "ior": 1.5, "alpha": 0.5, "alpha_t": 0.5}
_LAYERS = {
    # A rough base takes f0 to be below f90, as it is in every material.
    "DIFFUSE_ROUGH": ({"f90": ParameterRange(1.0, 1.0, (1.0,)), "diffuse_roughness": UNIT},
                      {"metallic": 0.0, "diffuse_roughness": 1.0}),
    "DIFFUSE_TRANSMISSION": ({"diffuse_transmission": UNIT, "diffuse_transmission_color": COLOR},
                             {"metallic": 0.0, "diffuse_transmission": 0.4, "diffuse_transmission_color": 1.0}),
    "THIN_SCATTER": ({"scattered_back": UNIT}, {"scattered_back": 0.5}),
    "SHEEN": ({"sheen_color": COLOR, "sheen_roughness": UNIT}, {"sheen_color": 1.0, "sheen_roughness": 0.5}),
    "IRIDESCENT": ({"film": UNIT, "film_ior": FILM_IOR, "film_thickness": THICKNESS, "film_walls": UNIT},
                   {"metallic": 0.0, "film": 1.0, "film_ior": 1.4, "film_thickness": 350.0, "film_walls": 0.0}),
    "CLEARCOAT": ({"coat": UNIT, "coat_alpha": ALPHA}, {"coat": 1.0, "coat_alpha": 0.1}),
}
"""By its switch, what a feature adds to the surface's members: their ranges, and their values for the furnace."""


def _surface(name: str, *features: str, failures: Mapping[str, str] | None = None) -> Lobe:
    """The surface with the features of these switches; `failures` as in `Lobe`."""
    parameters, white = dict(_SURFACE), dict(_WHITE_SURFACE)
    unused: dict[str, float] = {}
    for switch, (ranges, values) in _LAYERS.items():
        if switch in features:
            parameters, white = parameters | ranges, white | values
        else:
            unused |= dict.fromkeys(ranges.keys() - _SURFACE.keys(), 0.0)
    switches = {name: int(name in features) for name in ("ANISOTROPIC", "ZELTNER", *_LAYERS)}
    return Lobe(name, "surface", "surface", parameters, white, failures or {}, unused=unused, defines={
        "NDF": 0, "MASKING": 0, "FRESNEL": 0, "METALNESS": 2, **switches, **_SHOW_ALL},
        transmits="mirrored" if "DIFFUSE_TRANSMISSION" in features else "")


_MICROFACETS = tuple(
    _microfacet(ndf, masking, (i, j))
    for i, ndf in enumerate(NDFS)
    for j, masking in enumerate(MASKINGS)
)

LOBES: tuple[Lobe, ...] = (
    Lobe("lambert", "compare/lambert", "lambert", {"albedo": COLOR}, {"albedo": 1.0}, table=None),
    Lobe("burley", "compare/burley", "burley", {"albedo": COLOR, "perceptual_roughness": UNIT},
         {"albedo": 1.0, "perceptual_roughness": 0.5},
         {"energy": "brighter than white when rough, towards grazing", "furnace": "darker than white when smooth"},
         table=None),
    Lobe("eon", "compare/eon", "eon", {"albedo": COLOR, "sigma": UNIT}, {"albedo": 1.0, "sigma": 0.5}, table=None),
    _phong("plain_phong", "phong", {"energy": "all light counts as if it fell along the normal",
                                    "furnace": "it is not normalised", "reciprocity": "it divides by NoL alone"}),
    _phong("phong", "phong", {"furnace": "what points below the horizon is lost"}),
    _phong("blinn", "blinn", {"energy": "its normalisation is a fit", "furnace": "it darkens at grazing"}),
    _phong("normalized_blinn", "blinn", {"furnace": "it is white along the normal only"}),
    Lobe("ggx", "compare/ggx", "ggx", _GGX, _WHITE_GGX, {"furnace": _LOST}),
    Lobe("turquin", "compare/turquin", "turquin", _GGX, _WHITE_GGX, {"reciprocity": "the compensation knows only wo"}),
    Lobe("fdez_aguera", "compare/fdez_aguera", "fdez_aguera", _GGX, _WHITE_GGX,
         {"reciprocity": "the compensation knows only wo"}),
    Lobe("metal", "compare/metal", "metal", {"f0": F0, "tint": COLOR, "alpha": ALPHA_2},
         {"f0": 1.0, "tint": 1.0, "alpha": 0.5}),
    Lobe("conductor", "compare/conductor", "conductor",
         {"eta": ParameterRange(0.05, 4.0, (0.0, 1.0, 1.0001, 100.0), 3),
          "k": ParameterRange(0.0, 8.0, (0.0, 1e-4, 1e4, 1e12), 3), "alpha": ALPHA_2},
         {"eta": 0.2, "k": 1e6, "alpha": 0.5}),
    *(_glass(name, masking) for name in ("dielectric", "thin_dielectric") for masking in MASKINGS[:2]),
    *(_glass(name, MASKINGS[0], film=True) for name in ("dielectric", "thin_dielectric")),
    _surface("standard"),
    _surface("standard anisotropic", "ANISOTROPIC"),
    _surface("standard rough", "DIFFUSE_ROUGH"),
    _surface("standard translucent", "DIFFUSE_TRANSMISSION"),
    _surface("standard scattering", "DIFFUSE_TRANSMISSION", "THIN_SCATTER"),
    _surface("standard sheen", "SHEEN", failures={
        "reciprocity": "the interface below the fibres is dimmed for wo alone, so that white stays white"}),
    _surface("standard zeltner sheen", "SHEEN", "ZELTNER", failures={
        "reciprocity": "a linearly transformed cosine of wo alone is the lobe of the fibres"}),
    _surface("standard iridescent", "IRIDESCENT", failures={
        "reciprocity": "a film changes what enters below it for wo alone, so that white stays white"}),
    _surface("standard coated", "CLEARCOAT", failures={
        "reciprocity": "what the coat lets through depends on wo alone, so that stacks of any layers stay white"}),
    *_MICROFACETS,
)
"""All of them, the comparisons of microfacet.glsl last."""
