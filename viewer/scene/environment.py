"""Light from all around, as an equirectangular radiance map.

Direction to texture: u = 1/2 + atan2(z, x) / 2 pi, v = acos(y) / pi from the top row.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Environment:
    """A radiance map, or the function that decodes it when somebody first asks for its pixels.

    `rotation` turns it about +Y, in radians, counter-clockwise seen from above (towards the map's smaller u);
    `intensity` multiplies it. `digest` names the content: equal digests mean equal texels, so that what was baked
    from them can be found again without decoding; "" where nobody computed one.
    """

    name: str
    source: np.ndarray | Callable[[], np.ndarray]
    rotation: float = 0.0
    intensity: float = 1.0
    digest: str = ""

    def digest_parts(self) -> tuple[object, ...]:
        """What its light depends on, for `base.digest`: the file is not decoded where its digest is known."""
        return self.rotation, self.intensity, self.digest or self.radiance

    @property
    def radiance(self) -> np.ndarray:
        """Linear Rec. 709 radiance, (H, W, 3) float32, finite and not negative. A broken file raises InputError.

        A file is decoded again where nobody holds the array: 100 MB, for a large map, that a picture does not need.
        """
        return self.source() if callable(self.source) else self.source
