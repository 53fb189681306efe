"""How far apart two pictures look (FLIP) and are (RMSE, maximum)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Literal

import numpy as np

from ...base.counted import counted
from ...errors import InputError
from ...image.image import LINEAR_FORMATS, Image
from ...image.magma import magma
from ...scene.color import LUMINANCE

Kind = Literal["ldr", "hdr"]
# The largest radiance FLIP's tone map (ACES, Narkowicz' fit) takes to 0.85; sets the exposures of HDR-FLIP.
_WHITE = 2.11887


@dataclass(frozen=True, eq=False)
class Difference:
    """The distance of picture `b` from picture `a`, which is the reference.

    Transparent pictures are compared as seen over white; their alpha counts in `max` as a fourth channel.
    `kind` "ldr" compares displayed values in [0, 1], "hdr" linear radiance. `rmse` is the root of the mean over all
    pixels and R, G, B of the squared difference, `max` the largest absolute difference, `flip` the mean of `map`.
    """

    a: str
    b: str
    size: tuple[int, int]
    kind: Kind
    flip: float
    rmse: float
    max: float
    map: np.ndarray = field(repr=False)
    """FLIP of each pixel, (H, W) float32 in [0, 1]."""

    def to_json(self) -> dict[str, object]:
        return {"a": self.a, "b": self.b, "size": list(self.size), "flip": self.flip, "rmse": self.rmse,
                "max": self.max, "kind": "displayed values" if self.kind == "ldr" else "linear light"}

    def to_text(self) -> dict[str, object]:
        """`to_json` in words, for people."""
        facts = self.to_json()
        del facts["kind"]
        compared = "displayed colours (sRGB, LDR-FLIP)" if self.kind == "ldr" else "linear radiance (HDR-FLIP)"
        return facts | {"compared": compared}

    def map_image(self) -> Image:
        """The FLIP map in magma: black where the pictures agree, bright where they differ."""
        return Image.from_srgb(magma(self.map))

    def save_map(self, path: str | PathLike[str]) -> None:
        """Writes `map_image`; OutputError as `Image.save`."""
        self.map_image().save(path)


def compare(a: Image, b: Image, kind: Kind = "ldr", names: tuple[str, str] = ("a", "b")) -> Difference:
    """Picture `b` against the reference `a`: their displayed pictures ("ldr") or their radiance ("hdr").

    FLIP is that of Andersson et al. 2020 (LDR) and 2021 (HDR) at 67 pixels per degree. Raises InputError where the
    sizes differ or, in radiance, a pixel is not finite.
    """
    if a.size != b.size:
        raise InputError(names[1], "", f"is {_written(b.size)}, {names[0]} is {_written(a.size)}")
    if kind == "ldr":
        first, second = a.over(1), b.over(1)
        alphas = a.srgb[..., 3] / np.float32(255), b.srgb[..., 3] / np.float32(255)
    else:
        for image, name in ((a, names[0]), (b, names[1])):
            problem = not_finite(image.linear)
            if problem:
                raise InputError(name, "", problem)
        first, second = (image.linear[..., :3] + (1 - image.linear[..., 3:]) for image in (a, b))
        alphas = a.linear[..., 3], b.linear[..., 3]
    error = second.astype(np.float64) - first
    flip_map = _flip(first, second, kind)
    return Difference(*names, a.size, kind, float(flip_map.mean(dtype=np.float64)), math.sqrt(np.mean(error**2)),
                      float(max(np.abs(error).max(), np.abs(alphas[1] - alphas[0]).max())), flip_map)


def compare_files(a: str | PathLike[str], b: str | PathLike[str]) -> Difference:
    """`compare` of two picture files: in radiance where both are EXR or HDR, else as displayed (InputError)."""
    linear = all(Path(path).suffix.lower() in LINEAR_FORMATS for path in (a, b))
    return compare(Image.open(a), Image.open(b), "hdr" if linear else "ldr", (str(a), str(b)))


def not_finite(pixels: np.ndarray) -> str:
    """"" or how many pixels of (H, W, C) hold NaN or infinity, and where the first one lies."""
    bad = ~np.isfinite(pixels).all(axis=-1)
    count = int(bad.sum())
    if not count:
        return ""
    row, column = np.argwhere(bad)[0]
    return f"{counted(count, 'pixel')} NaN or infinite, the first at x={column}, y={row}"


def _flip(reference: np.ndarray, test: np.ndarray, kind: Kind) -> np.ndarray:
    """The FLIP map, (H, W) float32, of two (H, W, 3) pictures."""
    if np.array_equal(reference, test):
        return np.zeros(reference.shape[:2], np.float32)
    import flip_evaluator

    parameters: dict[str, float] = {}
    if kind == "hdr":
        reference, test = np.maximum(reference, 0), np.maximum(test, 0)
        parameters = _exposures(reference)
    pictures = (np.ascontiguousarray(picture, np.float32) for picture in (reference, test))
    return flip_evaluator.evaluate(*pictures, kind.upper(), applyMagma=False, parameters=parameters)[0][..., 0]


def _exposures(reference: np.ndarray) -> dict[str, float]:
    """What HDR-FLIP cannot find by itself: exposures for a picture of which half or more is black.

    It takes them from the largest and the median luminance (Andersson et al. 2021, section 3.2), and at a median of
    0 loops over infinities or ends the process; here the median of what is not black stands in.
    """
    luminance = reference @ LUMINANCE.astype(np.float32)
    if np.median(luminance) > 0:
        return {}
    lit = luminance[luminance > 0]
    if not lit.size:
        return {"startExposure": 0.0, "stopExposure": 0.0}
    return {"startExposure": math.log2(_WHITE / lit.max()), "stopExposure": math.log2(_WHITE / np.median(lit))}


def _written(size: tuple[int, int]) -> str:
    return f"{size[0]}x{size[1]}"
