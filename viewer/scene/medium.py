"""What fills a volume: light is attenuated on its way through it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium, by the coefficients of the equation of radiative transfer (Chandrasekhar 1960).

    `sigma_a` is the absorption coefficient, rgb per world unit: over a distance d the share exp(-sigma_a d) is left.
    It is all that there is as yet. The scattering coefficient sigma_s, a phase function, emission and a grid by which
    these vary will be fields beside it. Shaders read a medium by shaders/media/medium.glsl.
    """

    sigma_a: tuple[float, float, float] = (0.0, 0.0, 0.0)


VACUUM = Medium()
