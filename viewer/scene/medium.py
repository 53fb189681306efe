"""Participating media, which fill volumes and absorb, scatter and emit the light that travels through them."""

from __future__ import annotations

from dataclasses import dataclass

RGB = tuple[float, float, float]


@dataclass(frozen=True)
class Medium:
    """A homogeneous medium, given by the coefficients of the radiative transfer equation (Chandrasekhar 1960).

    `sigma_t` is the extinction coefficient, absorption and scattering together, RGB per world unit: over a distance d
    the transmittance is exp(-sigma_t d) (Beer's law). `albedo` is the single-scattering albedo, the share of extinction
    that is scattering, RGB in [0, 1]. `g`, in (-1, 1), is the mean cosine of the Henyey-Greenstein phase function: with
    g > 0 light is scattered forwards. A `droplet_diameter` above 0, in micrometres, means the phase function of
    droplets of water instead (Jendersie and d'Eon 2023). `emission` is radiance per world unit, RGB. Shaders read a
    medium in shaders/media/medium.glsl.
    """

    sigma_t: RGB = (0.0, 0.0, 0.0)
    albedo: RGB = (0.0, 0.0, 0.0)
    g: float = 0.0
    droplet_diameter: float = 0.0
    emission: RGB = (0.0, 0.0, 0.0)

    @property
    def sigma_a(self) -> RGB:
        """The absorption coefficient, RGB per world unit: sigma_t (1 - albedo)."""
        red, green, blue = (s * (1.0 - a) for s, a in zip(self.sigma_t, self.albedo, strict=True))
        return red, green, blue

    @property
    def scatters(self) -> bool:
        """Whether it scatters light."""
        return any(s > 0 and a > 0 for s, a in zip(self.sigma_t, self.albedo, strict=True))


VACUUM = Medium()
