"""Textures of rays whose rows are all traced, for passes that trace some without a wavefront of paths.

Apart from the path tracer, so that pictures which trace nothing need not import it.
"""

from __future__ import annotations

import moderngl
import numpy as np


class WholeTextures:
    """What `viewer.trace.rays.intersect.WavefrontTextures` has beside the textures, without shadow rays to the
    camera."""

    hit: moderngl.Texture
    sees_backs = False

    @property
    def rows(self) -> int:
        return self.hit.height

    def read(self, name: str, texels: np.ndarray) -> None:
        getattr(self, name).read_into(texels)
