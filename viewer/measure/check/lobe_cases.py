"""The parameter sets at which the package's lobes are checked, and what their models are known to break."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .energy import FURNACE_BOUND, LobeCase
from .lobes import LOBES, Lobe

ALPHA = (0.005, 0.02, 0.1, 0.3, 0.6, 1.0)
ANISOTROPIC = ((0.1, 0.4), (0.6, 0.05))
_SWEPT = {"sigma": (0.0, 0.3, 0.6, 1.0), "perceptual_roughness": (0.0, 0.5, 1.0), "shininess": (1.0, 10.0, 1000.0)}
_ETA = (1.05, 1.5, 2.4, 1 / 1.5)
_DRAWN = 6

# The table's names for what fails, and the checks that see it.
_CHECKS = {"energy": "reflects at most all", "furnace": "white furnace", "reciprocity": "reciprocity"}
# The lobes for comparison look up their albedo at one alpha, to which the geometric mean of the two is not quite the
# answer.
_ANISOTROPIC_FAILURES = {"white furnace", "albedo"}
_FURNACE_BOUNDS = {"metal": 2e-3, "conductor": 2e-3, "standard sheen": 1e-2}  # the albedo of fibres is a fit
_TABULATED = {"ggx", "turquin", "fdez_aguera", "surface", "microfacet", "lambert", "burley", "eon",
              "thin_dielectric"}


def lobe_cases() -> list[LobeCase]:
    """Every lobe at its white sets and at some drawn from its ranges; anisotropic ones apart."""
    cases = []
    for lobe in LOBES:
        cases.append(_case(lobe, _white_sets(lobe), drawn=True))
        if _size(lobe, "alpha") == 2:
            cases.append(_case(lobe, [{**lobe.white, "alpha": alpha} for alpha in ANISOTROPIC], drawn=False))
        elif lobe.defines.get("ANISOTROPIC"):
            cases.append(_case(lobe, [{**lobe.white, "alpha_t": t, "alpha": b} for t, b in ANISOTROPIC], drawn=False))
    return cases


def _case(lobe: Lobe, white: Sequence[dict], drawn: bool) -> LobeCase:
    values = {name: [np.broadcast_to(each[name], _shape(lobe, name)) for each in white] for name in lobe.parameters}
    if drawn:
        random = lobe.draw(np.random.default_rng(3), _DRAWN)
        for name in values:
            values[name] += list(random[name])
    arrays = {name: np.asarray(value, np.float64) for name, value in values.items()}
    if "alpha" in arrays:
        alpha = arrays["alpha"]
        # Narrower lobes are mirrors or fall between the nodes. What is drawn is isotropic, the others are a case apart.
        alpha = np.repeat(alpha[:, :1], 2, axis=1) if alpha.ndim == 2 and drawn else alpha
        arrays["alpha"] = np.where((alpha > 0) & (alpha < ALPHA[0]), ALPHA[0], alpha)
    if "coat_alpha" in arrays:  # a mirror beside a lobe that is none would be missing in the integrals
        arrays |= {name: np.maximum(arrays[name], ALPHA[0]) for name in ("alpha", "coat_alpha")}
    if "alpha_t" in arrays and drawn:
        arrays["alpha_t"] = arrays["alpha"]
    expected = {_CHECKS[name] for name in lobe.failures}
    # Light sent back along its way gains what it gained, and a factor that knows one side alone gains on the other.
    if lobe.failures.keys() & {"energy", "reciprocity"}:
        expected.add("hemisphere balance")
    is_tabulated = bool(lobe.defines.get("ANISOTROPIC"))
    if not drawn and not is_tabulated:
        expected |= _ANISOTROPIC_FAILURES
    stretched = f"{lobe.name}, stretched" if is_tabulated else f"{lobe.name}, anisotropic"
    return LobeCase(lobe.name if drawn else stretched, lobe, arrays,
                    np.arange(len(arrays[next(iter(arrays))])) < len(white), expected,
                    _FURNACE_BOUNDS.get(lobe.name, FURNACE_BOUND),
                    0.01 if lobe.prefix in _TABULATED else 0.05,  # the others take 32 or 64 samples
                    eta=arrays["eta"] if lobe.transmits == "refracted" else None, mirrors=lobe.transmits == "mirrored")


def _white_sets(lobe: Lobe) -> list[dict]:
    swept = [name for name in lobe.parameters if name in _SWEPT]
    if "eta" in lobe.parameters:
        return [{**lobe.white, "eta": eta, "alpha": alpha} for eta in _ETA if eta >= lobe.parameters["eta"].low
                for alpha in (0.05, 0.3, 1.0)]
    if "alpha" in lobe.parameters:
        return [{**lobe.white, "alpha": alpha} for alpha in ALPHA]
    return [{**lobe.white, swept[0]: value} for value in _SWEPT[swept[0]]] if swept else [dict(lobe.white)]


def _size(lobe: Lobe, name: str) -> int:
    return lobe.parameters[name].size if name in lobe.parameters else 0


def _shape(lobe: Lobe, name: str) -> tuple[int, ...]:
    return () if _size(lobe, name) == 1 else (_size(lobe, name),)
