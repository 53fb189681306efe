"""The lobes that an environment is prefiltered with, as functions of the angle from the mirror direction, and their
spectra.

For a view along the normal (n = v = r; Karis 2013, "Real Shading in Unreal Engine 4") a microfacet lobe weights light
at an angle theta by D(theta / 2) cos(theta). The Jacobian 1 / (4 VoH) cancels against VoH, and the DFG table accounts
for masking.
"""

from __future__ import annotations

import numpy as np

from ..settings import NDFS


def lobe(ndf: str, alpha: float, theta: np.ndarray) -> np.ndarray:
    """The weight of light at the angle `theta` from the mirror direction, in radians. It is 0 below the horizon.

    It is not normalised. D is as in Walter 2007, without its normalisation; Blinn-Phong's exponent is
    2 / alpha^2 - 2. (Phong's lobe, cos^s about the mirror direction, is close to Blinn-Phong's with half the alpha.)
    """
    cos_half, tan_half, cos_light = np.cos(theta / 2), np.tan(theta / 2), np.cos(theta)
    if ndf == "ggx":
        density = (alpha**2 / (tan_half**2 + alpha**2)) ** 2 / cos_half**4
    elif ndf == "beckmann":
        density = np.exp(-((tan_half / alpha) ** 2)) / cos_half**4
    elif ndf == "blinn-phong":
        density = cos_half ** (2 / alpha**2 - 2)
    else:
        raise ValueError(f"there is no distribution {ndf!r}; choose one of {', '.join(NDFS)}")
    return density * np.maximum(cos_light, 0)


def lobe_spectrum(ndf: str, alpha: float, degree: int) -> np.ndarray:
    """lambda_0 .. lambda_degree of the lobe, normalised to integrate to 1 over the sphere (so lambda_0 = 1), float64.

    The integrals use Gauss-Legendre quadrature in panels that grow with the distance from the peak. Each panel has 48
    nodes, enough for the twelve oscillations of P_255 in the widest one.
    """
    edges = [0.0, 0.5 * alpha]
    while edges[-1] < np.pi / 2:
        edges.append(min(edges[-1] + min(0.5 * edges[-1] + 0.25 * alpha, 0.3), np.pi / 2))
    nodes, weights = np.polynomial.legendre.leggauss(48)
    width = np.diff(edges)[:, None] / 2
    theta = (np.array(edges[:-1])[:, None] + width * (nodes + 1)).ravel()
    mass = (width * weights).ravel() * lobe(ndf, alpha, theta) * np.sin(theta)
    mass /= mass.sum()

    cosine, spectrum = np.cos(theta), np.empty(degree + 1)
    last, older = np.ones_like(theta), np.zeros_like(theta)
    spectrum[0] = 1.0
    for n in range(1, degree + 1):
        last, older = ((2 * n - 1) * cosine * last - (n - 1) * older) / n, last
        spectrum[n] = mass @ last
    return spectrum


def grazing_spectrum(degree: int) -> np.ndarray:
    """lambda_0 .. lambda_degree of the widest lobe that an environment is filtered with: that of roughness 1 seen at a
    grazing angle, NoV = 1/4. Without Fresnel's part it is NoL / (NoL + NoV), whatever the azimuth, since D is constant
    there and V = 1 / (2 (NoL + NoV)). The sum of a level with the cosine and of this one is near to it for all NoV."""
    node, weight = np.polynomial.legendre.leggauss(600)
    NoL = (node + 1) / 2
    mass = weight * NoL / (NoL + 0.25)
    return (mass / mass.sum()) @ np.polynomial.legendre.legvander(NoL, degree)
