"""What `Image.stats["estimated_error"]` holds, whatever has measured it; None in its place where nothing is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypedDict


class EstimatedError(TypedDict):
    """Errors are relMSE, the mean of (x - truth)^2 / (truth^2 + 0.01), which `relative` is the root of."""

    relmse: float
    low: float | None
    """With `high`, the ends of the 95 % interval; None where noise alone is told, in mode path."""
    high: float | None
    relative: float
    trimmed_relmse: float | None
    """Without the pixels of the largest errors; None where it is not measured."""
    brightness: float | None
    """The share of `relmse` that one factor for the whole picture would remove; None where it is not measured."""
    samples: float
    """Path-traced ones a pixel, by which it is known."""
    seconds: float
    """Spent on these."""
    notes: list[str]
    """Lines for the user: what of the error is there on purpose, and what paths do not find."""


def estimated_error(relmse: float, samples: float, seconds: float, interval: tuple[float, float] | None = None,
                    trimmed: float | None = None, brightness: float | None = None,
                    notes: Sequence[str] = ()) -> EstimatedError:
    """For JSON."""
    low, high = interval or (None, None)
    return {"relmse": relmse, "low": low, "high": high, "relative": math.sqrt(relmse), "trimmed_relmse": trimmed,
            "brightness": brightness, "samples": samples, "seconds": seconds, "notes": list(notes)}
