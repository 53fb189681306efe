"""Environments: light from all directions, as an equirectangular radiance map.

A direction (x, y, z) maps to the texture coordinates u = 1/2 + atan2(z, x) / 2 pi and v = acos(y) / pi; v = 0 is the
top row.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..base.expect import expect_number
from ..errors import UsageError
from .arrays import HoldsArrays, scene_array
from .light import BRIGHTEST

MAX_RADIANCE = 1e12
"""Of a texel: the luminance of the sun's disk is 2e9 cd/m2."""
MAX_INTENSITY = BRIGHTEST / MAX_RADIANCE


@dataclass(frozen=True, eq=False)
class Environment(HoldsArrays):
    """An environment map. `source` is its radiance, (H, W, 3) float32, or a function that decodes it on first access.

    `rotation` turns it about +Y, in radians, counter-clockwise seen from above (towards smaller u). `intensity`
    multiplies it. Radiance is at most 1e12 and intensity 1e18, whose product leaves float32 room for sums. `digest`
    identifies the content: equal digests mean equal texels, so a cached bake can be found without decoding the file. It
    is "" if none was computed.
    """

    name: str
    source: np.ndarray | Callable[[], np.ndarray]
    rotation: float = 0.0
    intensity: float = 1.0
    digest: str = ""
    warnings: tuple[str, ...] = ()
    """Lines for the user about what of the file is not as it might be expected."""

    def __post_init__(self) -> None:
        if not callable(self.source):
            radiance = scene_array(self.source, "Environment.source", np.float32, None, None, 3)
            if not radiance.size or radiance.min() < 0:
                raise UsageError(f"Environment.source {radiance.shape}: it must have texels, and none below 0")
            if radiance.max() > MAX_RADIANCE:
                raise UsageError(f"Environment.source {radiance.shape}: radiance {radiance.max():.3g} is over "
                                 f"{MAX_RADIANCE:g}")
            self._set("source", radiance)
        expect_number(self.rotation, "Environment.rotation", is_finite=True)
        expect_number(self.intensity, "Environment.intensity", 0.0, MAX_INTENSITY)

    def digest_parts(self) -> tuple[object, ...]:
        """The values that its light depends on, for `base.digest`. If `digest` is known, no file is decoded."""
        return self.rotation, self.intensity, self.digest or self.radiance

    @property
    def radiance(self) -> np.ndarray:
        """Linear Rec. 709 radiance, (H, W, 3) float32, finite and not negative. Raises InputError for a broken file.

        The array is not kept: if no caller holds it, the next access decodes the file again. A large map takes 100 MB,
        which rendering does not need once the environment is baked.
        """
        return self.source() if callable(self.source) else self.source
