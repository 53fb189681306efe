"""What the standard lobe does besides what is tested for all lobes: the choice of its Fresnel curve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from viewer.measure.check.lobes import LOBES

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
