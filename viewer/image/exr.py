"""Writes OpenEXR files: the picture and its layers, with the usual channel names."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..base.utf8_name import utf8_name

_CHANNELS = {"normal": "XYZ", "position": "XYZ", "motion": "XY", "uv": "UV", "depth": "Z"}
"""The channel names of layers that are neither colours nor plain numbers: "normal.X", "depth.Z"."""


def write_exr(path: Path, linear: np.ndarray, layers: Mapping[str, np.ndarray], attributes: Mapping[str, str]) -> None:
    """Write float32 channels R, G, B, A of `linear` (H, W, 4), and the channels of every layer.

    A layer (H, W, 3) has channels such as "albedo.R", a layer (H, W) one such as "samples.Y" (OpenEXR's "Standard
    channel names"). Layers of whole numbers are channels of uint32 in a second part, "ids": OpenImageIO writes parts of
    one type only. `attributes` go into the header. Raises OSError if the file cannot be written.
    """
    import OpenImageIO as oiio

    height, width = linear.shape[:2]
    whole = {name: layer for name, layer in layers.items() if layer.dtype.kind == "u"}
    named = {name: layer for name, layer in layers.items() if name not in whole}
    parts = [_part(list("RGBA"), linear, named, "float", attributes)]
    if whole:
        nothing = np.zeros((height, width, 0), np.uint32)
        parts = [*parts, _part([], nothing, whole, "uint", {})]
        for (spec, _), name in zip(parts, ("picture", "ids")):
            spec.attribute("oiio:subimagename", name)
    target = oiio.ImageOutput.create("exr")
    if target is None:
        raise OSError(oiio.geterror())
    specs = tuple(spec for spec, _ in parts)
    with utf8_name(path) as file:
        done = target.open(file, specs) if whole else target.open(file, specs[0])
        for k, (spec, pixels) in enumerate(parts):
            done = done and (k == 0 or target.open(file, spec, "AppendSubimage")) and target.write_image(pixels)
        if not (done and target.close()):
            raise OSError(target.geterror())


def _part(names: list[str], first: np.ndarray, layers: Mapping[str, np.ndarray], kind: str,
          attributes: Mapping[str, str]) -> tuple[Any, np.ndarray]:
    """The header of a part and its pixels: the channels `names` of `first`, and those of the layers."""
    import OpenImageIO as oiio

    height, width = first.shape[:2]
    arrays = [first]
    for name, layer in layers.items():
        array = layer.reshape(height, width, -1).astype(first.dtype)
        names += [f"{name}.{channel}" for channel in _CHANNELS.get(name, "RGB" if array.shape[2] == 3 else "Y")]
        arrays.append(array)
    spec = oiio.ImageSpec(width, height, len(names), kind)
    spec.channelnames = tuple(names)
    spec.attribute("compression", "zip")
    for key, value in attributes.items():
        spec.attribute(key, value)
    return spec, np.concatenate(arrays, axis=-1) if layers else first
