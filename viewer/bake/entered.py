"""Light that enters one fibre of a yarn: how much of it a layer of them sends out, and what is left of its colours.

As shaders/bsdf/weave/entered.glsl, of which this is the integral."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..scene.fibre import sigma_a_of_color
from ..scene.medium import RGB

R, SHARE = (0.82, 0.268), (0.932, 0.068)
"""ENTERED_R and ENTERED_SHARE there: of light straight through (TT), and of light that is reflected inside (TRT)."""
IOR, ROUGHNESS = 1.55, 0.3
AT_ONCE = 0.0636
"""n of a thick layer, along the normal."""
POWERS, PEAK = (4, 16), (0.58205, 1.1372)
"""Of the cosine of half the angle in the azimuth, and ENTERED_PEAK."""
_ALONG = 48
"""Quadrature nodes in s: those of Chebyshev's polynomials of the second kind."""
_AROUND = 8
"""Those of Gauss and Legendre, for each quarter of the azimuth."""


def colors_left(color: RGB) -> tuple[RGB, RGB]:
    """Of light that goes through a fibre, or is reflected inside it, what is left: the colours (passed, returned),
    linear. Since it often goes through two fibres in a row, what it has crossed is one and a half of them; inside, two.
    `color` is that of many fibres together; means over the offsets at which a fibre is met at a right angle."""
    h = (np.arange(64) + 0.5) / 64
    inside, outside = np.sqrt(1 - (h / IOR) ** 2), np.sqrt(1 - h * h)
    s, p = (outside - IOR * inside) / (outside + IOR * inside), (inside - IOR * outside) / (inside + IOR * outside)
    mirrored = (s * s + p * p) / 2
    through = np.exp(-2 * sigma_a_of_color(color, ROUGHNESS)[:, None] * inside)
    both = (((1 - mirrored) ** 2, through**1.5), ((1 - mirrored) ** 2 * mirrored, through**2))
    passed, returned = ((left * weight).sum(axis=1) / weight.sum() for weight, left in both)
    return tuple(passed.tolist()), tuple(returned.tolist())


def scattered_again(color: RGB) -> RGB:
    """The albedo, along the normal, of what a thick layer of fibres of this colour does to light that leaves the first
    one inwards: without what comes back at once, after it was reflected inside one fibre."""
    _, returned = colors_left(color)
    red, green, blue = (max(both - AT_ONCE * once, 0.0) / (1 - AT_ONCE) for both, once in zip(color, returned))
    return red, green, blue


def kernel(r: float, x: NDArray, y: NDArray) -> NDArray:
    """P(x, y), whose mean over y with the weight 2/pi sqrt(1 - y^2) is 1."""
    q, r2 = 1 - r * r, r * r
    return q / (q * q - 4 * r * (1 + r2) * x * y + 4 * r2 * (x * x + y * y))


def entered_share(alpha: float, thickness: float, sine: NDArray, azimuth: NDArray, cosine: NDArray) -> NDArray:
    """n(w): of light from w the share that leaves the layer after it has entered one fibre, for white fibres that
    mirror nothing. The arguments are those of `mirrored_share` in yarn.py."""
    b, s = np.sqrt(1 - sine**2), np.sqrt(1 - cosine**2)
    along = b * s * np.cos(azimuth) + sine * cosine
    across = s * np.sin(azimuth), b * cosine - sine * s * np.cos(azimuth)
    radius = np.sqrt(np.maximum(1 - along**2, 1e-12))
    turn = across[0] / radius, across[1] / radius
    a2 = alpha * alpha - 1
    lambda_o = np.sqrt(1 + a2 * along**2) / cosine
    total = np.zeros_like(along)
    nodes, node_weights = (part / 2 for part in np.polynomial.legendre.leggauss(_AROUND))
    for x in np.cos(np.arange(1, _ALONG + 1) * math.pi / (_ALONG + 1)).tolist():
        flat = 1 - x * x
        weights = [share * peak * 2 / (_ALONG + 1) * flat * kernel(r, along, -x)
                   for r, share, peak in zip(R, SHARE, PEAK)]
        area = math.sqrt(1 + a2 * x * x)
        # Where the azimuth crosses the surface
        level = np.arccos(np.clip(-sine * x / np.maximum(b * math.sqrt(flat), 1e-9), -1, 1))
        for node, weight in zip(0.5 + nodes, node_weights):
            for to, side in ((0.0, 1), (0.0, -1), (math.pi, 1), (math.pi, -1)):
                angle = side * (level + (to - level) * node**2)  # closer together near the surface
                up = sine * x + b * math.sqrt(flat) * np.cos(angle)
                c = turn[0] * np.sin(angle) + turn[1] * np.cos(angle)
                onwards, returned = (0.5 - 0.5 * c)**POWERS[0], (0.5 + 0.5 * c)**POWERS[1]
                lambda_i = area / np.maximum(np.abs(up), 1e-6)
                back = to == 0.0
                far = np.maximum(lambda_o, lambda_i) if back else np.abs(lambda_o - lambda_i)
                t = np.minimum(thickness * np.maximum(far, 1e-12), 80.0)
                k = -np.expm1(-t) / np.maximum(thickness * far, 1e-12)
                if not back:
                    k *= np.exp(-np.minimum(thickness * np.minimum(lambda_o, lambda_i), 80.0))
                width = 2 * node * weight * np.abs(to - level)
                total += width * (weights[0] * onwards + weights[1] * returned) * k
    return total * thickness * radius / cosine
