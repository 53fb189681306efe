"""Media in which light that is scattered nearly straight on counts as light that is not scattered.

A phase function whose series of Legendre polynomials begins with 1, g, f is taken for a forward peak with the share f
of the scattered light, and a wider lobe for the rest, so that these terms stay (delta-Eddington; Joseph, Wiscombe &
Weinman 1976). That of Henyey and Greenstein has f = g^2. Without its peak a medium has

    sigma_t' = (1 - albedo f) sigma_t,    albedo' = albedo (1 - f) / (1 - albedo f),    g' = (g - f) / (1 - f)

and light in it is diffuse after few collisions, as a diffusion equation presumes.
"""

from __future__ import annotations

from dataclasses import replace

from ..scene.medium import Medium
from ..scene.phase import spectrum


def without_peak(medium: Medium) -> Medium:
    """`medium` without the forward peak of its phase function, which is that of Henyey and Greenstein afterwards. Its
    extinction stays grey: the greatest albedo of the three channels counts for all."""
    _, g, peak = spectrum(medium, 3).tolist()
    if g <= 0:
        return medium
    kept = 1 - max(medium.albedo) * peak
    share = (1 - peak) / kept
    red, green, blue = medium.sigma_t
    return replace(medium, sigma_t=(kept * red, kept * green, kept * blue), g=(g - peak) / (1 - peak),
                   albedo=(share * medium.albedo[0], share * medium.albedo[1], share * medium.albedo[2]),
                   droplet_diameter=0.0)
