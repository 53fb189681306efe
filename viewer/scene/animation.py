"""Animations: key frames of properties, and the values between them."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple, get_args

import numpy as np

from ..errors import UsageError
from .arrays import scene_array

Interpolation = Literal["step", "linear", "cubic"]


class Target(NamedTuple):
    """What a track moves: the property `name` of thing `number` of a kind of things.

    Of a node: translation, rotation, scale, weights, or `weights[k]` for one of them.
    """

    kind: str
    number: int
    name: str


@dataclass(frozen=True, eq=False)
class Track:
    """The key frames of one property.

    `times` (K,) float32, in seconds, none before its predecessor. `values` (K, C) float32; for "cubic" (K, 3, C): the
    tangent that comes in, the value, the tangent that goes out, tangents per second. Values of a rotation are
    quaternions x, y, z, w, C = 4.

    Raises UsageError for arrays that do not fit each other.
    """

    target: Target
    times: np.ndarray
    values: np.ndarray
    interpolation: Interpolation = "linear"

    def __post_init__(self) -> None:
        if self.interpolation not in get_args(Interpolation):
            raise UsageError(f"Track.interpolation is {self.interpolation!r}, not one of "
                             f"{', '.join(get_args(Interpolation))}")
        times = scene_array(self.times, "Track.times", np.float32, None)
        if not len(times) or (np.diff(times) < 0).any():
            raise UsageError("Track.times: there must be one, and each must follow the one before")
        shape = (len(times), 3, None) if self.interpolation == "cubic" else (len(times), None)
        object.__setattr__(self, "times", times)
        object.__setattr__(self, "values", scene_array(self.values, "Track.values", np.float32, *shape))

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        self.__post_init__()

    @property
    def is_rotation(self) -> bool:
        return self.target.name == "rotation"

    def at(self, time: float) -> np.ndarray:
        """The value at `time` seconds, (C,) float64; before the first key frame and after the last one, theirs.

        A rotation is a unit quaternion. Formulas: glTF 2.0, appendix C.
        """
        times, values = self._seconds, self.values
        middle = values[:, 1] if self.interpolation == "cubic" else values
        k = bisect_right(times, time) - 1
        if k < 0 or k + 1 >= len(times) or self.interpolation == "step":
            value = middle[max(k, 0)].astype(np.float64)
        else:
            length = times[k + 1] - times[k]  # above 0: `time` is at or after times[k], and before times[k + 1]
            u = (time - times[k]) / length
            a, b = middle[k].astype(np.float64), middle[k + 1].astype(np.float64)
            if self.interpolation == "cubic":
                value = hermite(a, length * values[k, 2].astype(np.float64), b,
                                length * values[k + 1, 0].astype(np.float64), u)
            else:
                value = slerp(a, b, u) if self.is_rotation else a + u * (b - a)
        return unit_quaternion(value) if self.is_rotation else value

    @cached_property
    def _seconds(self) -> list[float]:
        return self.times.tolist()


@dataclass(frozen=True, eq=False)
class Animation:
    """Tracks that are played together, in the time of all of them."""

    name: str
    tracks: tuple[Track, ...]

    @property
    def duration(self) -> float:
        """The time of the last key frame, in seconds; 0 if there is one time only."""
        return max((float(track.times[-1]) for track in self.tracks), default=0.0)

    @property
    def moves(self) -> str:
        """What it moves, in words: "rotation of 19 nodes, weights of 1 node"."""
        counts: Counter[tuple[str, str]] = Counter()
        for kind, _, name in {track.target._replace(name=track.target.name.split("[")[0]) for track in self.tracks}:
            counts[name, kind] += 1
        return ", ".join(f"{name} of {count} {kind}{'s' * (count > 1)}"
                         for (name, kind), count in sorted(counts.items())) or "nothing"


def hermite(a: np.ndarray, out_of_a: np.ndarray, b: np.ndarray, into_b: np.ndarray, u: float) -> np.ndarray:
    """The cubic from `a` at u = 0 to `b` at u = 1 with these derivatives by u at its ends."""
    u2, u3 = u * u, u * u * u
    return ((2 * u3 - 3 * u2 + 1) * a + (u3 - 2 * u2 + u) * out_of_a + (3 * u2 - 2 * u3) * b + (u3 - u2) * into_b)


def slerp(a: np.ndarray, b: np.ndarray, u: float) -> np.ndarray:
    """From quaternion `a` to `b` on the shorter great circle, (4,); u is 0 to 1.

    sin((1 - u) x) / sin x and sin(u x) / sin x weight the two, x being the angle between them (Shoemake 1985). At a
    small x, where this is 0 / 0, the weights 1 - u and u are right to x^2.
    """
    a, b = unit_quaternion(a), unit_quaternion(b)
    cosine = float(a @ b)
    if cosine < 0:  # -b is the same rotation
        b, cosine = -b, -cosine
    if cosine > 1 - 1e-9:
        return (1 - u) * a + u * b
    angle = np.arccos(cosine)
    return (np.sin((1 - u) * angle) * a + np.sin(u * angle) * b) / np.sin(angle)


def unit_quaternion(value: np.ndarray) -> np.ndarray:
    """The quaternion at length 1; the identity if it has no length."""
    peak = float(np.abs(value).max())
    if not peak > 0:
        return np.array([0.0, 0.0, 0.0, 1.0])
    value = value / peak  # so that squares neither overflow nor underflow
    return value / np.sqrt(value @ value)
