"""An image file a texture refers to, decoded only when its pixels are asked for."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class TextureImage:
    """Encoded bytes and where they came from. See `open_texture_image` for the checks made up front."""

    name: str
    data: bytes
    width: int
    height: int
    format: str

    def decode(self) -> np.ndarray:
        raise NotImplementedError
