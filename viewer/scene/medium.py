"""Participating media, which fill volumes and attenuate the light that travels through them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium, given by coefficients of the radiative transfer equation (Chandrasekhar 1960).

    `sigma_a` is the absorption coefficient, RGB per world unit: over a distance d the transmittance is
    exp(-sigma_a d) (Beer's law). This is the only coefficient so far. A scattering coefficient sigma_s, a phase
    function, emission and a density grid would be further fields. Shaders read a medium in shaders/media/medium.glsl.
    """

    sigma_a: tuple[float, float, float] = (0.0, 0.0, 0.0)


VACUUM = Medium()
