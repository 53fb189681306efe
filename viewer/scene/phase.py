"""Phase functions as series of Legendre polynomials, by which they act on light from all around."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from .medium import Medium


def spectrum(medium: Medium, count: int) -> NDArray[np.float64]:
    """c_0 to c_(count - 1) of the phase function p = sum of (2 l + 1) / 4 pi c_l P_l(mu), (count,).

    c_0 is 1, and c_1 the mean cosine. That of Henyey and Greenstein 1941 has g^l. Droplets are a mixture of it and of
    Draine's, which is that times (1 + a mu^2) / n (Jendersie and d'Eon 2023; shaders/media/droplets.glsl).
    """
    if medium.droplet_diameter <= 0:
        return np.asarray(medium.g ** np.arange(count), np.float64)
    d = min(max(medium.droplet_diameter, 5.0), 50.0)
    g, g_wide = math.exp(-0.0990567 / (d - 1.67154)), math.exp(-2.20679 / (d + 3.91029) - 0.428934)
    a = math.exp(3.62489 - 8.29288 / (d + 5.52825))
    share = math.exp(-0.599085 / (d - 0.641583) - 0.665888)
    wide = np.asarray(g_wide ** np.arange(count + 2), np.float64)
    draine = (wide[:count] + a * _times_mu(_times_mu(wide))[:count]) / (1 + a * (1 + 2 * g_wide**2) / 3)
    mixed: NDArray[np.float64] = (1 - share) * g ** np.arange(count) + share * draine
    return mixed


def mean_cosine(medium: Medium) -> float:
    """The mean cosine of the angle by which the medium scatters light."""
    return float(spectrum(medium, 2)[1])


def _times_mu(c: NDArray[np.float64]) -> NDArray[np.float64]:
    """The series of mu p: mu P_l = (l P_(l-1) + (l + 1) P_(l+1)) / (2 l + 1). The last of its terms is not whole."""
    order = np.arange(len(c))
    before, after = np.append(0.0, c[:-1]), np.append(c[1:], 0.0)
    result: NDArray[np.float64] = (order * before + (order + 1) * after) / (2 * order + 1)
    return result
