"""Golden images: is a picture still the stored one, but for what another rasteriser may round differently?"""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np

from ...base.atomic import atomic_write
from ...errors import InputError, UsageError
from ...image.image import Image
from .difference import Difference, compare, not_finite


@dataclass(frozen=True)
class Limits:
    """What a picture may differ by and still be the golden one.

    Pixels whose every channel lies within `rounding` of the golden's count as equal: levels of 255 in displayed
    pictures, 255ths of the golden's value (at least 0.001) in linear ones. What is left may have a mean FLIP of
    `flip` and a difference of `maximum` (1.0 is all of the displayed range; None: any) in a channel of a pixel.

    The defaults let a driver round otherwise everywhere and move a silhouette by two of four samples here and there,
    and catch a 0.5 % change of the picture's look: FLIP is about 0.02 where every pixel is off by 2 levels.
    """

    flip: float = 0.005
    maximum: float | None = 0.5
    rounding: float = 2

    @classmethod
    def of(cls, **values: float | None) -> Limits:
        """With some given. Raises UsageError for one that does not exist, or is no number from 0 on."""
        names = [field.name for field in fields(cls)]
        for name, value in values.items():
            if name not in names:
                raise UsageError(f"there is no limit {name!r}, but {', '.join(names)}")
            if not ((isinstance(value, (int, float)) and value >= 0) or (name == "maximum" and value is None)):
                raise UsageError(f"{name}={value!r}: it is a number from 0 on")
        return cls(**values)  # type: ignore[arg-type]


@dataclass(frozen=True, eq=False)
class Failure:
    """A picture that is not its golden one; `expected` and `difference` are None where there is none to compare."""

    test: str
    golden: Path
    problem: str
    actual: Image
    expected: Image | None = None
    difference: Difference | None = None

    def write(self, folder: Path) -> None:
        """Writes expected.png, actual.png, difference.png (as far as they exist) and failure.json."""
        folder.mkdir(parents=True, exist_ok=True)
        for name, image in (("actual", self.actual), ("expected", self.expected),
                            ("difference", self.difference.map_image() if self.difference is not None else None)):
            if image is not None:
                image.save(folder / f"{name}.png")
        facts = {"test": self.test, "golden": str(self.golden), "problem": self.problem}
        with atomic_write(folder / "failure.json") as file:
            file.write_text(json.dumps(facts, indent=1))


def as_image(picture: Image | np.ndarray) -> Image:
    """An Image, or (H, W, 3 or 4) uint8 displayed values or floating linear ones as one. Raises UsageError."""
    __tracebackhide__ = True
    if isinstance(picture, Image):
        return picture
    if not hasattr(picture, "__array__"):
        raise UsageError(f"the picture is of type {type(picture).__name__}, not an Image or an array")
    pixels = np.asarray(picture)
    if pixels.ndim != 3 or pixels.shape[2] not in (3, 4) or not pixels.size:
        raise UsageError(f"the picture is an array {pixels.shape}, not (H, W, 3 or 4)")
    if pixels.dtype == np.uint8:
        return Image.from_srgb(pixels)
    if pixels.dtype.kind != "f":
        raise UsageError(f"the picture is of {pixels.dtype}, not uint8 (as displayed) or floating (linear)")
    return Image.from_linear(pixels)


def judge(actual: Image, golden: Path, limits: Limits, test: str) -> Failure | None:
    """None where `actual` is the picture stored at `golden` (.exr: its radiance, else as displayed)."""
    problem = not_finite(actual.linear)
    if problem:
        return Failure(test, golden, problem, actual)
    if not golden.exists():
        return Failure(test, golden, "there is no golden image yet", actual)
    expected = Image.open(golden)
    linear = golden.suffix.lower() == ".exr"
    try:
        compared = _forgive(actual, expected, linear, limits.rounding) if actual.size == expected.size else actual
        difference = compare(expected, compared, "hdr" if linear else "ldr", ("the golden image", "the picture"))
    except InputError as error:
        return Failure(test, golden, str(error), actual, expected)
    problems = []
    if difference.flip > limits.flip:
        problems.append(f"FLIP {difference.flip:.4f} > {limits.flip:g}")
    if limits.maximum is not None and difference.max > limits.maximum:
        problems.append(f"maximum {difference.max:.3f} > {limits.maximum:g}")
    if not problems:
        return None
    return Failure(test, golden, ", ".join(problems), actual, expected, difference)


def _forgive(actual: Image, expected: Image, linear: bool, rounding: float) -> Image:
    """`actual` with the expected pixel wherever the two lie within `rounding`."""
    if linear:
        near = np.abs(actual.linear - expected.linear) <= np.maximum(np.abs(expected.linear) * (rounding / 255), 1e-3)
    else:
        near = np.abs(actual.srgb.astype(np.int16) - expected.srgb) <= rounding
    equal = near.all(axis=-1, keepdims=True)
    return Image(np.where(equal, expected.linear, actual.linear), np.where(equal, expected.srgb, actual.srgb))
