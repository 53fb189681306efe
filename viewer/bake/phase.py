"""The environment convolved with the phase function of a medium: what a point of it scatters into each direction."""

from __future__ import annotations

import numpy as np

from .irradiance import HEIGHT
from .prefilter import MARGIN, row_angles
from .spherical_convolution import Filter, convolve


def scattered_sky(level: np.ndarray, g: float) -> np.ndarray:
    """The map of the integral of L(w) p(w . d) for each direction d, (64, 128, 3) float32, with a margin at the poles.

    `level` is a level of an environment's mip chain, which has that margin, too (`viewer.bake.prefilter`). The
    Henyey-Greenstein phase function p has the spectrum g^l (Henyey & Greenstein 1941).
    """
    margin = round(len(level) * MARGIN)
    radiance = level[margin:len(level) - margin].astype(np.float32)
    theta = row_angles(HEIGHT)
    [scattered] = convolve(radiance, [Filter(theta[:HEIGHT // 2], float(g) ** np.arange(HEIGHT))])
    return np.maximum(scattered, 0)
