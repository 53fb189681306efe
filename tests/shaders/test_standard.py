"""What the standard lobe does besides what is tested for all lobes: the choice of its Fresnel curve, and that all
combinations of its layers keep the light."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from viewer.measure.check.energy import LobeCase, check_lobe
from viewer.measure.check.lobes import LOBES, _surface

STANDARD = next(lobe for lobe in LOBES if lobe.name == "standard")
MU = np.array([1.0, 0.7, 0.3, 0.1, 0.01])


def mirrored(fresnel: int, ior: float, weight: float) -> np.ndarray:
    """What a black, smooth dielectric reflects, for each of MU."""
    lobe = replace(STANDARD, defines={**STANDARD.defines, "FRESNEL": fresnel})
    f0 = weight * ((ior - 1) / (ior + 1)) ** 2
    wo = np.stack([np.sqrt(1 - MU**2), 0 * MU, MU], axis=-1)
    found = lobe.sample(lobe.struct(base_color=0.0, metallic=0.0, f0=f0, f90=weight, alpha=0.0, ior=ior), wo,
                        np.zeros(3))
    return (found["weight"] * found["pdf"][:, None]).astype(np.float64)


@pytest.mark.parametrize("ior", [1.0, 1.33, 1.5, 2.4])
@pytest.mark.parametrize("weight", [1.0, 0.5])
def test_exact_is_fresnels_curve(ior, weight):
    """Unpolarised, by Snell's law; its weight scales it."""
    inner = np.sqrt(1 - (1 - MU**2) / ior**2)
    r_s = (MU - ior * inner) / (MU + ior * inner)
    r_p = (ior * MU - inner) / (ior * MU + inner)
    expected = weight * (r_s**2 + r_p**2) / 2
    np.testing.assert_allclose(mirrored(1, ior, weight), np.repeat(expected[:, None], 3, axis=1), atol=2e-5)


def test_schlick_is_the_default():
    f0 = 0.04
    expected = f0 + (1 - f0) * (1 - MU) ** 5
    np.testing.assert_allclose(mirrored(0, 1.5, 1.0), np.repeat(expected[:, None], 3, axis=1), atol=1e-5)


@pytest.mark.parametrize("fibres", ["charlie", "zeltner"])
def test_white_stays_white_below_any_combination_of_layers(fibres):
    """Of the BSDF itself, down to grazing angles, by the program that has all layers; weights of 0 leave them out."""
    layers = ("DIFFUSE_ROUGH", "DIFFUSE_TRANSMISSION", "SHEEN", "IRIDESCENT", "CLEARCOAT")
    weights = ("diffuse_roughness", "diffuse_transmission", "sheen_color", "film", "coat")
    lobe = _surface("layers", *layers, *["ZELTNER"] * (fibres == "zeltner"))
    chosen = np.array(list(product((0.0, 1.0), repeat=len(layers))))
    chosen = chosen if fibres == "charlie" else chosen[chosen[:, 2] > 0]
    values = {name: np.full(len(chosen), lobe.white.get(name, 0.0)) for name in lobe.parameters}
    for name, weight in zip(weights, chosen.T):
        values[name] = values[name] * weight
    values = {name: value if lobe.parameters[name].size == 1 else np.repeat(value[:, None], 3, axis=1)
              for name, value in (values | {"metallic": 0.0 * chosen[:, 0]}).items()}
    case = LobeCase("layers", lobe, values, np.ones(len(chosen), bool), furnace_bound=0.01, provides=frozenset(),
                    mirrors=True)
    checks = dict(zip(("white furnace", "reflects at most all"), check_lobe(case)))
    assert {name: str(check) for name, check in checks.items() if not check.passed} == {}
