"""What a fibre does to light: the parameters of the hair model of Chiang, Bitterli, Tappan and Burley (2016)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import UsageError
from ..settings import HAIR_COLORS, Settings
from .arrays import scene_numbers
from .medium import RGB

EUMELANIN = np.array([0.419, 0.697, 1.37])
PHEOMELANIN = np.array([0.187, 0.4, 1.05])
"""Absorption of a unit of each pigment, RGB per radius of the fibre (d'Eon and others 2011; as in Mitsuba and pbrt)."""
MIN_VARIANCE = 4e-6
"""As MIN_FIBRE_VARIANCE in shaders/bsdf/fibre/fibre.glsl."""
BROWN = (1.3, 0.0)
"""The melanin of hair whose colour nothing says."""
DARKEST = 1e-4
"""The darkest colour that `sigma_a_of_color` tells from black, whose absorption would be infinite."""


@dataclass(frozen=True)
class Fibre:
    """A dielectric cylinder with absorption and rough scales, whose radius is the unit of length.

    `sigma_a` is the absorption coefficient, RGB per radius. `beta_m` and `beta_n` in [0, 1] are the longitudinal and
    the azimuthal roughness. `tilt`, in radians, is the angle of the scales. Its sign is that of Mitsuba and pbrt: the
    first reflection takes theta_o - 2 tilt with the axis from the root to the tip, which leans it to the tip. `ior` is
    the index of refraction.

    Raises UsageError for numbers that cannot be this.
    """

    sigma_a: RGB
    beta_m: float = 0.3
    beta_n: float = 0.3
    tilt: float = math.radians(2.0)
    ior: float = 1.55

    def __post_init__(self) -> None:
        object.__setattr__(self, "sigma_a", scene_numbers(self.sigma_a, "Fibre.sigma_a", 3))
        if min(self.sigma_a) < 0:
            raise UsageError(f"Fibre.sigma_a is {self.sigma_a}: an absorption is not negative")
        for name, low, high in (("beta_m", 0.0, 1.0), ("beta_n", 0.0, 1.0), ("tilt", -math.pi / 4, math.pi / 4),
                                ("ior", 1.0, 3.0)):
            if not low <= getattr(self, name) <= high:
                raise UsageError(f"Fibre.{name} is {getattr(self, name)}, not a number from {low:g} to {high:g}")


def sigma_a_of_melanin(eumelanin: float, pheomelanin: float) -> RGB:
    """The absorption, RGB per radius, of so much of the black-brown and of the yellow-red pigment of hair."""
    red, green, blue = (eumelanin * EUMELANIN + pheomelanin * PHEOMELANIN).tolist()
    return red, green, blue


def sigma_a_of_color(color: ArrayLike, beta_n: float) -> np.ndarray:
    """The absorption (..., 3) float64, per radius, at which many fibres together have the colour (..., 3), linear
    Rec. 709: the fit of Chiang and others (2016, equation 9), which depends on the azimuthal roughness.

    The fit has no absorption below 0 for colours above 1; they are taken as 1.
    """
    return np.square(np.log(np.clip(np.asarray(color, np.float64), DARKEST, 1.0)) / color_fit(beta_n))


def color_fit(beta_n: float) -> float:
    """The factor f in color = exp(-f sqrt(sigma_a)) (ibid.)."""
    return 5.969 - 0.215 * beta_n + 2.532 * beta_n**2 - 10.73 * beta_n**3 + 5.574 * beta_n**4 + 0.245 * beta_n**5


def longitudinal_variance(beta_m: float) -> float:
    """Of the inclinations that one reflection spreads light over (ibid., equation 7)."""
    root = 0.726 * beta_m + 0.812 * beta_m**2 + 3.7 * beta_m**20
    return max(root**2, MIN_VARIANCE)


def hair_fibre(settings: Settings) -> Fibre:
    """The fibre that the settings `hair-...` describe."""
    beta_m, beta_n = settings.hair_roughness
    if settings.hair_absorption is not None:
        sigma_a = settings.hair_absorption
    elif settings.hair_color is not None:
        red, green, blue = sigma_a_of_color(settings.hair_color, beta_n).tolist()
        sigma_a = red, green, blue
    else:
        sigma_a = sigma_a_of_melanin(*(settings.hair_melanin or BROWN))
    return Fibre(sigma_a, beta_m, beta_n, math.radians(settings.hair_tilt), settings.hair_ior)


def gives_color(settings: Settings) -> bool:
    """Whether a setting says what colour hair has, so that the colours of files do not count."""
    return any(getattr(settings, name) is not None for name in HAIR_COLORS)
