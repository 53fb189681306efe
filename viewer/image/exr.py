"""Writes OpenEXR files: the picture and its layers, with the usual channel names."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ..base.utf8_name import utf8_name

_CHANNELS = {"normal": "XYZ", "depth": "Z"}
"""The channel names of layers that are neither colours nor plain numbers: "normal.X", "depth.Z"."""


def write_exr(path: Path, linear: np.ndarray, layers: Mapping[str, np.ndarray], attributes: Mapping[str, str]) -> None:
    """Write float32 channels R, G, B, A of `linear` (H, W, 4), and the channels of every layer.

    A layer (H, W, 3) has channels such as "albedo.R", a layer (H, W) one such as "samples.Y" (OpenEXR's "Standard
    channel names"). `attributes` go into the header. Raises OSError if the file cannot be written.
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
