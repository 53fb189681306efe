"""Animations: key frames of properties, and the values between them."""

from __future__ import annotations

from bisect import bisect_right
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple, get_args

import numpy as np

from ..base.counted import counted
from ..errors import UsageError
from .arrays import HoldsArrays, scene_array

Interpolation = Literal["step", "linear", "cubic"]


class Target(NamedTuple):
    """What a track moves: the property `name` of thing `number` of a kind of things.

    Of a node: translation, rotation, scale, weights, or `weights[k]` for one of them.
    """

    kind: str
    number: int
    name: str


@dataclass(frozen=True, eq=False)
class Track(HoldsArrays):
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
        self._set("times", times)
        self._set("values", scene_array(self.values, "Track.values", np.float32, *shape))

    @property
    def is_rotation(self) -> bool:
        return self.target.name == "rotation"

    def at(self, time: float) -> np.ndarray:
        """The value at `time` seconds, (C,) float64; before the first key frame and after the last one, theirs.

        A rotation is a unit quaternion.
        """
        return _sampled([self], time)[0]

    @cached_property
    def seconds(self) -> list[float]:
        """`times` as Python's numbers, which are found faster."""
        return self.times.tolist()


@dataclass(frozen=True, eq=False)
class Animation:
    """Tracks that are played together, in the time of all of them."""

    name: str
    tracks: tuple[Track, ...]

    @cached_property
    def duration(self) -> float:
        """The time of the last key frame, in seconds, from 0 on."""
        return max((float(track.times[-1]) for track in self.tracks if track.times[-1] > 0), default=0.0)

    def at(self, time: float) -> dict[Target, np.ndarray]:
        """The values of all targets at `time` seconds, as `Track.at` has them."""
        values: dict[Target, np.ndarray] = {}
        for tracks in self._alike:
            values.update(zip([track.target for track in tracks], _sampled(tracks, time)))
        return values

    @cached_property
    def _alike(self) -> list[list[Track]]:
        """Tracks that are sampled together: most files have the same times for all of them, or a few."""
        groups: dict[tuple[object, ...], list[Track]] = {}
        for track in self.tracks:
            key = track.times.tobytes(), track.interpolation, track.is_rotation, track.values.shape
            groups.setdefault(key, []).append(track)
        return list(groups.values())

    @property
    def moves(self) -> str:
        """What it moves, in words: "rotation of 19 nodes, weights of 1 node"."""
        counts: Counter[tuple[str, str]] = Counter()
        for kind, _, name in {track.target._replace(name=track.target.name.split("[")[0]) for track in self.tracks}:
            counts[name, kind] += 1
        return ", ".join(f"{name} of {counted(count, kind)}"
                         for (name, kind), count in sorted(counts.items())) or "nothing"


def _sampled(tracks: Sequence[Track], time: float) -> np.ndarray:
    """The values of T tracks of the same times, shape and interpolation, (T, C) float64 (glTF 2.0, appendix C)."""
    first = tracks[0]
    times, is_cubic = first.seconds, first.interpolation == "cubic"
    k = bisect_right(times, time) - 1
    is_between = 0 <= k < len(times) - 1 and first.interpolation != "step"
    k = max(k, 0)
    keys = np.array([track.values[k:k + 1 + is_between] for track in tracks], np.float64)
    if not is_between:
        value = keys[:, 0, 1] if is_cubic else keys[:, 0]
    else:
        length = times[k + 1] - times[k]  # above 0: `time` is at or after times[k], and before times[k + 1]
        u = (time - times[k]) / length
        if is_cubic:
            value = hermite(keys[:, 0, 1], length * keys[:, 0, 2], keys[:, 1, 1], length * keys[:, 1, 0], u)
        elif first.is_rotation:
            value = slerp(keys[:, 0], keys[:, 1], u)
        else:
            value = keys[:, 0] + u * (keys[:, 1] - keys[:, 0])
    return unit_quaternions(value) if first.is_rotation else value


def hermite(a: np.ndarray, out_of_a: np.ndarray, b: np.ndarray, into_b: np.ndarray, u: float) -> np.ndarray:
    """The cubic from `a` at u = 0 to `b` at u = 1 with these derivatives by u at its ends."""
    u2, u3 = u * u, u * u * u
    return (2 * u3 - 3 * u2 + 1) * a + (u3 - 2 * u2 + u) * out_of_a + (3 * u2 - 2 * u3) * b + (u3 - u2) * into_b


def slerp(a: np.ndarray, b: np.ndarray, u: float) -> np.ndarray:
    """From quaternions `a` to `b`, (T, 4), on the shorter great circle; u is 0 to 1.

    sin((1 - u) x) / sin x and sin(u x) / sin x weight the two, x being the angle between them (Shoemake 1985). At a
    small x, where this is 0 / 0, the weights 1 - u and u are right to x^2.
    """
    a, b = unit_quaternions(a), unit_quaternions(b)
    cosine = np.einsum("ij,ij->i", a, b)[:, None]
    b, cosine = np.where(cosine < 0, -b, b), np.abs(cosine)  # -b is the same rotation
    angle = np.arccos(np.minimum(cosine, 1.0))
    is_small = cosine > 1 - 1e-9
    sine = np.where(is_small, 1.0, np.sin(angle))
    return (np.where(is_small, 1 - u, np.sin((1 - u) * angle) / sine) * a
            + np.where(is_small, u, np.sin(u * angle) / sine) * b)


def unit_quaternions(values: np.ndarray) -> np.ndarray:
    """Quaternions (T, 4) at length 1; the identity for those without length."""
    peak = np.abs(values).max(axis=1, keepdims=True)
    scaled = values / np.where(peak > 0, peak, 1.0)  # so that squares neither overflow nor underflow
    scaled[:, 3:][~(peak > 0)] = 1.0
    return scaled / np.sqrt(np.einsum("ij,ij->i", scaled, scaled))[:, None]
