"""Writing OpenEXR: the picture and, beside it, its layers, in channels named as the field names them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..base.utf8_name import utf8_name

_CHANNELS = {"normal": "XYZ", "depth": "Z"}
"""What is not a colour or a plain number: "normal.X", "depth.Z"."""


def write_exr(path: Path, linear: np.ndarray, layers: Mapping[str, np.ndarray], attributes: Mapping[str, str]) -> None:
    """Write float32 channels R, G, B, A of `linear` (H, W, 4), and those of every layer after a dot behind its name.

    Layers are (H, W, 3), as "albedo.R", or (H, W), as "samples.Y" (OpenEXR's "Standard channel names"). `attributes` go
    into the header. Raises OSError where that fails.
    """
    import OpenImageIO as oiio

    height, width = linear.shape[:2]
    names, arrays = list("RGBA"), [linear]
    for name, layer in layers.items():
        array = layer.reshape(height, width, -1)
        names += [f"{name}.{channel}" for channel in _CHANNELS.get(name, "RGB" if array.shape[2] == 3 else "Y")]
        arrays.append(array)
    spec = oiio.ImageSpec(width, height, len(names), "float")
    spec.channelnames = tuple(names)
    spec.attribute("compression", "zip")
    for key, value in attributes.items():
        spec.attribute(key, value)
    target = oiio.ImageOutput.create("exr")
    if target is None:
        raise OSError(oiio.geterror())
    pixels = np.concatenate(arrays, axis=-1) if layers else linear
    with utf8_name(path) as file:
        if not (target.open(file, spec) and target.write_image(pixels) and target.close()):
            raise OSError(target.geterror())
