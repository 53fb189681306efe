"""A picture, and pictures of it that are wrong in one way each, (SIZE, SIZE, 3)."""

from __future__ import annotations

import numpy as np

from viewer.estimate.neighbourhood import smooth

SIZE = 48


def truth() -> np.ndarray:
    """Light and dark sides with an edge, and a texture."""
    y, x = np.mgrid[:SIZE, :SIZE] / SIZE
    shade = np.where(x + y < 1, 0.1, 0.8) * (1 + 0.3 * np.sin(40 * x) * np.cos(31 * y))
    return (shade[..., None] * [1.0, 0.8, 0.5]).astype(np.float32)


RASTERS = {
    "too bright": truth() * 1.3,
    "too dark in the shade": truth() * np.where(truth() < 0.2, 0.5, 1).astype(np.float32),
    "without texture": smooth(smooth(truth(), 2), 4),
    "one bright spot": truth() + np.float32(0.7) * (np.hypot(*(np.mgrid[:SIZE, :SIZE] - 24)) < 2)[..., None],
}
