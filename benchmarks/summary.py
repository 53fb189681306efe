"""From runs to figures: medians with their spread, and ratios taken within a round."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from .process import Run
from .programs import OURS, OURS_EVERYTHING, OURS_MULTISAMPLED

Rounds = dict[str, list[Run]]
"""The runs of each program, one a round, in order."""


@dataclass(frozen=True)
class Spread:
    """Of `n` values: the median, and the 10th and 90th percentile by linear interpolation."""

    median: float
    p10: float
    p90: float
    n: int

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        if len(values) == 1:
            return cls(values[0], values[0], values[0], 1)
        tenths = statistics.quantiles(values, n=10, method="inclusive")
        return cls(statistics.median(values), tenths[0], tenths[-1], len(values))


@dataclass(frozen=True)
class Target:
    """Ours may take at most `bound` times what the best of some rivals takes."""

    phase: str
    key: str
    bound: float
    rivals: str
    """`image-based`: those that light by the HDR; `f3d`: f3d on any back end; `all` others; `everything`: our own plan
    that leaves nothing out."""


TARGETS = (
    Target("cold", "wall_s", 0.5, "image-based"),
    Target("warm", "wall_s", 0.4, "f3d"),
    Target("frame 512x512", "frame_median_ms", 0.5, "image-based"),
    Target("frame 1280x720", "frame_median_ms", 0.5, "image-based"),
    Target("cold", "wall_s", 1.0, "everything"),
    Target("frame 512x512", "frame_median_ms", 1.0, "everything"),
    Target("cold", "rss_mb", 1.0, "all"),
    Target("warm", "rss_mb", 1.0, "all"),
    Target("frame 512x512", "rss_mb", 1.0, "all"),
    Target("frame 1280x720", "rss_mb", 1.0, "all"),
)


@dataclass(frozen=True)
class Verdict:
    target: Target
    rival: str
    ratio: Spread

    @property
    def reached(self) -> bool:
        return self.ratio.median <= self.target.bound


def values(runs: Iterable[Run], key: str) -> list[float]:
    """What the runs that did not fail have under `key`; all single frames where the program lists them."""
    if key == "frame_median_ms":
        return [ms for run in runs for ms in run.get("frame_ms", [run[key]] if key in run else [])]
    return [run[key] for run in runs if key in run]


def ratios(runs: Sequence[Run], others: Sequence[Run], key: str) -> list[float]:
    """Round by round, so that what slows the machine for a while slows both."""
    return [run[key] / other[key] for run, other in zip(runs, others) if key in run and key in other]


def judge(target: Target, rounds: Rounds, image_based: set[str]) -> Verdict | None:
    """Ours against the best rival by median; None where one of the two has no runs of this phase."""
    ours = rounds.get(OURS, [])
    medians = {}
    for name, runs in rounds.items():
        found = [run[target.key] for run in runs if target.key in run]
        is_other = name not in (OURS, OURS_MULTISAMPLED, OURS_EVERYTHING)
        eligible = {"image-based": is_other and name in image_based, "f3d": name.startswith("f3d"), "all": is_other,
                    "everything": name == OURS_EVERYTHING}
        if found and eligible[target.rivals]:
            medians[name] = statistics.median(found)
    if not medians:
        return None
    rival = min(medians, key=medians.__getitem__)
    within = ratios(ours, rounds[rival], target.key)
    return Verdict(target, rival, Spread.of(within)) if within else None
