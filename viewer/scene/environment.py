"""Light from all around, as an equirectangular radiance map.

Direction to texture: u = 1/2 + atan2(z, x) / 2 pi, v = acos(y) / pi from the top row.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Environment:
    """Linear Rec. 709 radiance, (H, W, 3) float32, finite and not negative.

    `rotation` turns it about +Y, in radians, counter-clockwise seen from above (towards the map's smaller u);
    `intensity` multiplies it.
    """

    name: str
    radiance: np.ndarray
    rotation: float = 0.0
    intensity: float = 1.0
