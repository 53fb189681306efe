"""The environment convolved with the phase function of a medium: what a point of it scatters into each direction."""

from __future__ import annotations

import numpy as np

from ..scene.equirect import texel_directions
from ..scene.medium import Medium
from ..scene.phase import spectrum
from .irradiance import HEIGHT
from .prefilter import MARGIN, row_angles
from .spherical_convolution import Filter, convolve_each

MAPS = 4


def scattered_sky(level: np.ndarray, medium: Medium) -> np.ndarray:
    """MAPS maps of integrals for each direction d, one below the other, (4 * 64, 128, 3) float32:

        integral of L(w) p(w . d),    and of L(w) w_k p(w . d) for the axes k = x, y, z.

    From them follows the integral of L(w) p(w . d) T(w), where a transmittance T is linear in w. `level` is a level of
    an environment's mip chain, which has a margin at the poles (`viewer.bake.prefilter`), as each map has. p is the
    phase function of `medium`.
    """
    margin = round(len(level) * MARGIN)
    radiance = level[margin:len(level) - margin].astype(np.float32)
    theta = row_angles(HEIGHT)
    phase = Filter(theta[:HEIGHT // 2], spectrum(medium, HEIGHT))
    axes = texel_directions(*radiance.shape[:2]).astype(np.float32)
    weighted = [radiance, *(radiance * axes[..., k, None] for k in range(3))]
    scattered, *moments = (result for [result] in convolve_each(weighted, [phase]))
    return np.concatenate([np.maximum(scattered, 0), *moments])
