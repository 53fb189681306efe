"""Weaves: which yarn of a woven cloth lies above, and what its fibres do to light. Read from JSON, or by a name."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

from ..errors import InputError
from .files import read_file
from .json_text import parse_json
from .medium import RGB

MAX_SIDE = 16
"""The most yarns of one system in a draft."""
LEAST_BEND = 4.0
"""In degrees: how much yarns bend at least, for they cross."""


@dataclass(frozen=True)
class Yarn:
    """A yarn: a layer of about parallel fibres on a bent cylinder.

    `color` is the albedo of a thick layer of its fibres seen along the normal, without what they mirror, linear;
    `specular` the share of light that they mirror, and `roughness` in (0, 1] the alpha of the spread of their
    directions. `thickness` is the optical thickness of the yarn, `through` the share of the light that it scatters
    which leaves on the other side, if the fibres absorb none. `twist`, in degrees, is the angle of the outermost fibres
    to the yarn, `bend` the largest angle of the yarn to the cloth, and `width` the share of its cell that it fills.
    """

    color: RGB = (0.5, 0.5, 0.5)
    specular: RGB = (0.1, 0.1, 0.1)
    roughness: float = 0.2
    thickness: float = 8.0
    through: float = 0.15
    twist: float = 15.0
    bend: float = 30.0
    width: float = 0.95

    @property
    def seen_twist(self) -> float:
        """In degrees: the mean twist of the fibres that are seen along the normal.

        The tangent of the twist grows evenly from the axis of the yarn to its surface, and what is seen is an optical
        thickness of 1 deep: the mean of 1 - 2 x / T by exp(-x), up to the yarn's T, is coth(T / 2) - 2 / T.
        """
        half = self.thickness / 2
        share = half / 3 if half < 0.1 else 1 / math.tanh(half) - 1 / half
        return math.degrees(math.atan(share * math.tan(math.radians(self.twist))))


@dataclass(frozen=True)
class Weave:
    """`draft` has a row for each weft yarn, in the direction of v, and in it for each warp yarn, in the direction of u,
    whether the warp lies above. It repeats. `density` is the number of warp yarns per unit of u and of weft yarns per
    unit of v."""

    draft: tuple[tuple[bool, ...], ...]
    warp: Yarn = Yarn()
    weft: Yarn = Yarn()
    density: tuple[float, float] = (100.0, 100.0)

    @property
    def has_gaps(self) -> bool:
        """Whether anything shows through between yarns."""
        return self.warp.width < 1 and self.weft.width < 1

    @property
    def flatness(self) -> tuple[float, float]:
        """The height of a warp yarn over its width, and that of a weft yarn, where they fill the room between them.

        Where a yarn goes over one other, its axis is an arc whose slope at the ends is that of `Yarn.bend`, and a
        quarter of that slope high, in lengths of the arc. Where two yarns cross, two arcs and two halves of
        cross-sections fill the same height (Hearle and Shanahan 1978): each is as thick as the other's arc is high.
        """
        warp, weft = (math.tan(math.radians(max(yarn.bend, LEAST_BEND))) for yarn in (self.warp, self.weft))
        return weft / (2 * self.warp.width), warp / (2 * self.weft.width)

    @property
    def mean_color(self) -> RGB:
        """About the colour of the cloth from afar: that of each yarn by the share of cells in which it lies above."""
        cells = [above for row in self.draft for above in row]
        share = sum(cells) / len(cells)
        red, green, blue = (share * a + (1 - share) * b for a, b in zip(self.warp.color, self.weft.color))
        return red, green, blue


def _draft(*rows: str) -> tuple[tuple[bool, ...], ...]:
    return tuple(tuple(c == "1" for c in row) for row in rows)


_SILK = Yarn(color=(0.35, 0.02, 0.04), specular=(0.3, 0.25, 0.25), roughness=0.12, twist=0.0, bend=18.0, width=1.0)
WEAVES = {
    "plain": Weave(_draft("10", "01"), Yarn((0.6, 0.55, 0.45)), Yarn((0.62, 0.58, 0.5))),
    "twill": Weave(_draft("1100", "0110", "0011", "1001"), Yarn((0.12, 0.12, 0.14), width=1.0),
                   Yarn((0.3, 0.3, 0.32), width=1.0)),
    "satin": Weave(_draft("01111", "11011", "11110", "10111", "11101"), _SILK, replace(_SILK, bend=8.0)),
    "denim": Weave(_draft("1110", "0111", "1011", "1101"), Yarn((0.02, 0.035, 0.12), twist=25.0, width=1.0),
                   Yarn((0.6, 0.6, 0.57), twist=25.0, width=1.0)),
}
"""Weaves by their names."""

_RANGES = {"roughness": (0.02, 1.0), "thickness": (0.0, 1e4), "through": (0.0, 1.0), "twist": (-60.0, 60.0),
           "bend": (0.0, 60.0), "width": (0.05, 1.0)}


def read_weave(path: Path) -> Weave:
    """A weave of a JSON file: `draft`, a list of rows of the same length, of "1" where the warp lies above and "0"; and
    optionally `density`, and `warp` and `weft` with the fields of `Yarn`. Raises InputError."""
    values = _object(path, "", parse_json(path, read_file(path)), {f.name for f in fields(Weave)})
    if "draft" not in values:
        raise InputError(path, "draft", "it is missing")
    density = values.get("density", (100.0, 100.0))
    if not isinstance(density, (list, tuple)) or len(density) != 2:
        raise InputError(path, "density", "it must be two numbers")
    across, along = (_number(path, f"density[{k}]", value, 1e-6, 1e6) for k, value in enumerate(density))
    yarns = {name: _yarn(path, name, values.get(name, {})) for name in ("warp", "weft")}
    return Weave(_read_draft(path, values["draft"]), density=(across, along), **yarns)


def _read_draft(path: Path, rows: Any) -> tuple[tuple[bool, ...], ...]:
    if not isinstance(rows, list) or not 2 <= len(rows) <= MAX_SIDE:
        raise InputError(path, "draft", f"it must be a list of 2 to {MAX_SIDE} rows")
    for k, row in enumerate(rows):
        if not isinstance(row, str) or set(row) - {"0", "1"} or not 2 <= len(row) <= MAX_SIDE:
            raise InputError(path, f"draft[{k}]", f'a row must be 2 to {MAX_SIDE} of the characters "0" and "1"')
        if len(row) != len(rows[0]):
            raise InputError(path, f"draft[{k}]", f"it has {len(row)} yarns, and the first row {len(rows[0])}")
        if len(set(row)) == 1:
            raise InputError(path, f"draft[{k}]", "this weft yarn never crosses to the other side: the weave does not "
                                                  "hold together")
    for k, column in enumerate(zip(*rows)):
        if len(set(column)) == 1:
            raise InputError(path, f"draft, column {k}", "this warp yarn never crosses to the other side: the weave "
                                                         "does not hold together")
    return _draft(*rows)


def _yarn(path: Path, place: str, data: Any) -> Yarn:
    values = _object(path, place, data, {f.name for f in fields(Yarn)})
    found: dict[str, Any] = {}
    for name, value in values.items():
        where = f"{place}.{name}"
        if name in _RANGES:
            if name == "width" and isinstance(value, (int, float)) and value > 1:
                raise InputError(path, where, "a yarn is not wider than its cell, which is 1")
            found[name] = _number(path, where, value, *_RANGES[name])
        elif not isinstance(value, list) or len(value) != 3:
            raise InputError(path, where, "it must be three numbers, linear red, green and blue")
        else:
            most = 1.0 if name == "color" else 0.5
            found[name] = tuple(_number(path, f"{where}[{k}]", part, 0.0, most) for k, part in enumerate(value))
    return Yarn(**found)


def _object(path: Path, place: str, data: Any, known: set[str]) -> Mapping[str, Any]:
    if not isinstance(data, dict):
        raise InputError(path, place, "it must be an object")
    unknown = sorted(data.keys() - known)
    if unknown:
        raise InputError(path, place, f"there is no key {unknown[0]!r}; choose from {', '.join(sorted(known))}")
    return data


def _number(path: Path, place: str, value: Any, low: float, high: float) -> float:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or not low <= value <= high:
        raise InputError(path, place, f"it must be a number from {low:g} to {high:g}")
    return float(value)
