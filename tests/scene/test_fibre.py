"""What a fibre is, and the absorption that pigments and colours mean."""

from __future__ import annotations

import math

import numpy as np
import pytest

from viewer.errors import UsageError
from viewer.scene.fibre import DARKEST, Fibre, gives_color, hair_fibre, sigma_a_of_color, sigma_a_of_melanin
from viewer.settings import Settings


def test_the_defaults_are_those_of_other_renderers():
    fibre = Fibre(sigma_a_of_melanin(1.3, 0.2))
    assert fibre.sigma_a == pytest.approx((1.3 * 0.419 + 0.2 * 0.187, 1.3 * 0.697 + 0.2 * 0.4, 1.3 * 1.37 + 0.2 * 1.05))
    assert (fibre.beta_m, fibre.beta_n, fibre.ior) == (0.3, 0.3, 1.55) and fibre.tilt == pytest.approx(0.0349066)


def test_a_colour_means_the_absorption_of_the_fit():
    # By hand at beta_n = 0.3 the fit is 5.969 - 0.0645 + 0.22788 - 0.28971 + 0.0451494 + 0.00059535.
    found = sigma_a_of_color([0.5, 1.0, 0.1], 0.3)
    np.testing.assert_allclose(found, [(math.log(0.5) / 5.88841475) ** 2, 0, (math.log(0.1) / 5.88841475) ** 2])
    assert sigma_a_of_color(np.full((2, 5, 3), 0.3), 0.3).shape == (2, 5, 3)


def test_what_is_no_colour_of_hair_has_a_finite_absorption_from_0_up():
    black, white = sigma_a_of_color([0.0, DARKEST, 1e-3], 0.3), sigma_a_of_color([1.0, 2.0, 1e9], 0.3)
    assert black[0] == black[1] > black[2] > 0 and not white.any()


@pytest.mark.parametrize("values, problem", [
    ({"sigma_a": (1, -1, 1)}, "Fibre.sigma_a is (1.0, -1.0, 1.0): an absorption is not negative"),
    ({"sigma_a": (1, 1)}, "Fibre.sigma_a is (2,)"), ({"beta_m": 1.1}, "Fibre.beta_m is 1.1, not a number from 0 to 1"),
    ({"beta_n": math.nan}, "Fibre.beta_n is nan"), ({"ior": 0.9}, "Fibre.ior is 0.9, not a number from 1 to 3"),
    ({"tilt": 2.0}, "Fibre.tilt is 2.0, not a number from -0.785398 to 0.785398"),
])
def test_what_is_no_fibre_is_refused(values, problem):
    with pytest.raises(UsageError) as error:
        Fibre(**{"sigma_a": (1, 1, 1)} | values)
    assert str(error.value).startswith(problem)


def test_the_fibre_of_the_settings():
    assert hair_fibre(Settings()) == Fibre(sigma_a_of_melanin(1.3, 0)) and not gives_color(Settings())
    given = {"hair_roughness": (0.2, 0.4), "hair_tilt": -3, "hair_ior": 1.4}
    rest = (0.2, 0.4, math.radians(-3), 1.4)
    assert hair_fibre(Settings.of(hair_melanin=(0, 2), **given)) == Fibre(sigma_a_of_melanin(0, 2), *rest)
    assert hair_fibre(Settings.of(hair_absorption=(1, 2, 3), **given)) == Fibre((1, 2, 3), *rest)
    colored = Settings.of(hair_color=(0.5, 0.3, 0.1), **given)
    assert hair_fibre(colored) == Fibre(tuple(sigma_a_of_color((0.5, 0.3, 0.1), 0.4)), *rest) and gives_color(colored)
