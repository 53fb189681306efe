from __future__ import annotations

import numpy as np
import pytest

from viewer.bake.lobes import lobe, lobe_spectrum
from viewer.settings import NDFS


@pytest.mark.parametrize("ndf", NDFS)
@pytest.mark.parametrize("alpha", [0.0144, 0.13, 1.0])
def test_spectrum_against_a_fine_sum(ndf, alpha):
    theta = (np.arange(100000) + 0.5) * (np.pi / 2e5)
    mass = lobe(ndf, alpha, theta) * np.sin(theta)
    spectrum = lobe_spectrum(ndf, alpha, 255)
    for degree in (0, 1, 2, 30, 255):
        legendre = np.polynomial.legendre.Legendre.basis(degree)(np.cos(theta))
        assert spectrum[degree] == pytest.approx((mass * legendre).sum() / mass.sum(), abs=1e-6)


def test_the_roughest_ggx_lobe_is_the_cosine():
    assert lobe_spectrum("ggx", 1.0, 4) == pytest.approx([1, 2 / 3, 1 / 4, 0, -1 / 24], abs=1e-12)


def test_no_light_from_below_the_horizon():
    assert all(lobe(ndf, 0.5, np.array([1.6, 3.0])).max() == 0 for ndf in NDFS)


def test_an_unknown_lobe_is_refused():
    with pytest.raises(ValueError, match="ggx, beckmann, blinn-phong"):
        lobe("gxx", 0.5, np.zeros(1))
