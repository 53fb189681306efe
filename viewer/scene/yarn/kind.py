"""What a yarn is spun of, by the parameters of Zhao and others (2016), "Fitting Procedural Yarn Models"."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ...errors import UsageError
from ...ranges import Range, Several
from ..fibre import Fibre, sigma_a_of_color
from ..medium import RGB

PRESSED = 1.15
"""Plies press against each other: each is wider than high by this factor."""
_RANGES = {"plies": Range(1, 8, is_whole=True), "fibres": Range(1, 4096, is_whole=True), "twist": Range(-60, 60),
           "fibre_twist": Range(-60, 60), "radius": Range(1e-4, 0.5), "color": Several(0, 1),
           "roughness": Several(0, 1, names="along,about"), "tilt": Range(-45, 45), "ior": Range(1, 3),
           "beta": Range(0, 10), "epsilon": Range(0, 0.5), "lowest": Range(0, 1), "highest": Range(0, 1),
           "migration": Range(0, 10), "loops": Range(0, 1), "loop_reach": Range(1, 3), "hairs": Range(0, 100),
           "hair_length": Range(0.01, 100), "hair_reach": Range(0, 10)}


@dataclass(frozen=True)
class YarnKind:
    """A yarn of `plies` that are twisted about its axis, each of so many `fibres`. Lengths are in radii of the yarn.

    `twist` is the angle in degrees between the yarn and the outermost line of its plies, above 0 a right-handed screw
    (Z), `fibre_twist` that between a ply and its outermost fibres, in a frame that turns with the ply. `radius` is that
    of a fibre.

    A fibre keeps about the distance R from the axis of its ply, as a share of the ply's radius. Its density over the
    cross-section is (1 - 2 epsilon) ((e - e^R) / (e - 1))^beta + epsilon. It migrates from `lowest` R to `highest` R
    and back, `migration` times while it goes round once.

    What leaves the ply: a share `loops` of the outer fibres, each of which migrates out to `loop_reach`, and `hairs` on
    each radius of the yarn's length, which are about `hair_length` long and end about `hair_reach` outside of the yarn.

    `color` is that of many fibres together, linear; `roughness` (along, about), `tilt` in degrees and `ior` are those
    of `Fibre`. Raises UsageError for numbers that cannot be this.
    """

    plies: int
    fibres: int
    twist: float
    fibre_twist: float
    radius: float
    color: RGB
    roughness: tuple[float, float]
    tilt: float = 0.0
    ior: float = 1.55
    beta: float = 0.2
    epsilon: float = 0.0
    lowest: float = 0.85
    highest: float = 1.0
    migration: float = 1.1
    loops: float = 0.05
    loop_reach: float = 1.3
    hairs: float = 0.3
    hair_length: float = 3.0
    hair_reach: float = 0.5

    def __post_init__(self) -> None:
        for name, valid in _RANGES.items():
            value = getattr(self, name)
            object.__setattr__(self, name, valid.number(value, f"YarnKind.{name} is {value!r}: it"))
        if self.lowest > self.highest:
            raise UsageError(f"YarnKind.lowest is {self.lowest}, above the highest, {self.highest}")
        if self.radius > self.ply_radius:
            raise UsageError(f"YarnKind.radius is {self.radius}, above that of a ply, {self.ply_radius:.3g}")

    @property
    def ply_radius(self) -> float:
        """That of circles which touch each other and the yarn's, as many as there are plies; they lie `ply_offset` from
        its axis."""
        return 1.0 if self.plies == 1 else 1.0 / (1.0 + 1.0 / math.sin(math.pi / self.plies))

    @property
    def ply_offset(self) -> float:
        return 1.0 - self.ply_radius

    @property
    def ply_width(self) -> float:
        """Half of it, about the yarn. Up to sqrt(ply_radius) the ellipse stays within the yarn."""
        return min(PRESSED * self.ply_radius, math.sqrt(self.ply_radius))

    @property
    def turns(self) -> tuple[float, float]:
        """How often the plies go round the yarn, and fibres round their ply, on one radius of its length."""
        about_yarn = math.tan(math.radians(self.twist)) / (2 * math.pi)
        return about_yarn, math.tan(math.radians(self.fibre_twist)) / (2 * math.pi * self.ply_radius)

    @property
    def fibre(self) -> Fibre:
        """What a fibre of its own colour does to light."""
        along, about = self.roughness
        red, green, blue = sigma_a_of_color(np.array(self.color), about).tolist()
        return Fibre((red, green, blue), along, about, math.radians(self.tilt), self.ior)


YARNS = {
    "cotton": YarnKind(3, 12, twist=32.0, fibre_twist=-25.0, radius=0.06, color=(0.6, 0.52, 0.4),
                       roughness=(0.4, 0.5), hairs=0.2),
    "wool": YarnKind(2, 18, twist=25.0, fibre_twist=-20.0, radius=0.055, color=(0.45, 0.36, 0.27),
                     roughness=(0.35, 0.4), tilt=-3.0, lowest=0.6, loops=0.2, loop_reach=1.6, hairs=0.6,
                     hair_length=5.0, hair_reach=0.9),
    "silk": YarnKind(1, 36, twist=8.0, fibre_twist=0.0, radius=0.07, color=(0.6, 0.2, 0.18), roughness=(0.12, 0.25),
                     lowest=0.95, loops=0.0, hairs=0.02),
}
"""Yarns by their names. Real yarns have a few times as many fibres, and thinner ones."""
